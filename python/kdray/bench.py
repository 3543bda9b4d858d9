"""`python -m kdray.bench`: the same rays through kdray, embreex, trimesh and Open3D, where installed.

All go from NumPy arrays to NumPy arrays, in the layout that each of them takes. They take turns, round after
round, so that what slows the machine for a while slows all of them; medians are reported.
"""

from __future__ import annotations

import argparse
import gzip
import importlib
import importlib.metadata
import json
import lzma
import math
import os
import pathlib
import platform
import statistics
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from . import __version__
from .devices import devices
from .errors import Error, InputError, NoDeviceError
from .looks import Camera
from .rays import pinhole_rays
from .scene import Scene

Array = npt.NDArray[Any]

RAY_TASKS = ("closest", "occlusion")
POINT_TASKS = ("closest-point", "signed-distance")
TASKS = (*RAY_TASKS, *POINT_TASKS)
CLASSES = ("primary", "diffuse", "random")
ENGINES = ("kdray", "embreex", "trimesh", "open3d")


# ---- What is traced


@dataclass(frozen=True)
class Mesh:
    """A scene: triangles, and where they are seen from."""

    name: str
    vertices: Array
    triangles: Array
    camera: Camera

    @property
    def ends(self) -> tuple[Array, Array]:
        """The least and the greatest coordinates."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    @property
    def size(self) -> float:
        """The diagonal of its box."""
        low, high = self.ends
        return float(np.linalg.norm(high - low))


@dataclass(frozen=True)
class Query:
    """Rays (two arrays) or points (one), float32, and how far an occlusion ray goes."""

    origins: Array
    directions: Array | None = None
    t_max: float = math.inf

    def __len__(self) -> int:
        return len(self.origins)

    def part(self, first: int, end: int) -> Query:
        """Rays first to end."""
        directions = None if self.directions is None else self.directions[first:end]
        return Query(self.origins[first:end], directions, self.t_max)


def sphere(n: int = 512) -> Mesh:
    """A bumpy ball of about 2*n*n triangles, closed."""
    latitude = np.linspace(0, np.pi, n + 1)[1:-1, None]
    longitude = np.arange(n) * (2 * np.pi / n)
    radius = 1 + 0.15 * np.sin(9 * latitude) ** 2 * np.sin(11 * longitude) + 0.01 * np.sin(60 * latitude)
    flat = radius * np.sin(latitude)
    rings = np.stack([flat * np.cos(longitude), flat * np.sin(longitude), radius * np.cos(latitude)], axis=-1)
    vertices = np.concatenate([rings.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]])
    a = np.arange((n - 1) * n).reshape(n - 1, n)
    b = np.roll(a, -1, axis=1)
    top, bottom = np.full(n, len(vertices) - 2), np.full(n, len(vertices) - 1)
    triangles = [
        np.stack([a[:-1], a[1:], b[1:]], -1).reshape(-1, 3),
        np.stack([a[:-1], b[1:], b[:-1]], -1).reshape(-1, 3),
    ]
    triangles += [np.stack([top, a[0], b[0]], -1), np.stack([bottom, b[-1], a[-1]], -1)]
    camera = Camera((2.4, -1.2, 0.9), (0, 0, 0), (0, 0, 1), 50)
    return Mesh("sphere", vertices.astype(np.float32), np.concatenate(triangles).astype(np.int32), camera)


def room(n: int = 12000) -> Mesh:
    """A room with n boxes in it, seen from inside; closed surfaces, 12 triangles each."""
    random = np.random.default_rng(1)
    low, high = np.array([-5.0, -5, 0]), np.array([5.0, 5, 4])
    edges = random.uniform(0.02, 0.12, (n, 3))
    middles = random.uniform(low + 0.2, high - 0.2, (n, 3))
    middles[:, 2] = 0.2 + 3.6 * random.random(n) ** 3  # heaps: most of them lie low
    aside = np.linalg.norm(middles[:, :2] - [-3.5, -3.5], axis=1) < 1.2
    middles[aside, 2] *= 0.3  # where the camera stands
    turn = np.linalg.qr(random.normal(size=(n, 3, 3)))[0]
    turn[:, 0] *= np.linalg.det(turn)[:, None]
    corners = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)]) - 0.5
    boxes = np.einsum("nij,nkj->nki", turn, corners * edges[:, None]) + middles[:, None]
    walls = (corners + 0.5) * (high - low) + low
    quads = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
    sides = np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])
    vertices = np.concatenate([boxes.reshape(-1, 3), walls]).astype(np.float32)
    triangles = (np.arange(n + 1)[:, None, None] * 8 + sides).reshape(-1, 3).astype(np.int32)
    return Mesh("room", vertices, triangles, Camera((-3.5, -3.4, 2.2), (1, 1.3, 1), (0, 0, 1), 75))


BUILT_IN: dict[str, Callable[[], Mesh]] = {"sphere": sphere, "room": room}


def read(path: str) -> Mesh:
    """A mesh file, by trimesh or Open3D: all engines are to have the same triangles by the same numbers."""
    file = pathlib.Path(path)
    if not file.exists():
        raise InputError(f"{path}: no such file, and no scene of that name; there are {', '.join(BUILT_IN)}")
    trimesh, open3d = _module("trimesh"), _module("open3d")
    if trimesh is not None:
        openers: dict[str, Any] = {".gz": gzip.open, ".xz": lzma.open}
        kind = pathlib.Path(file.stem if file.suffix in openers else file).suffix[1:]
        with openers.get(file.suffix, open)(file, "rb") as opened:
            mesh = trimesh.load(opened, file_type=kind, force="mesh", process=False)
        vertices, triangles = mesh.vertices, mesh.faces
    elif open3d is not None:
        mesh = open3d.io.read_triangle_mesh(path)
        vertices, triangles = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    else:
        raise InputError(f"{path}: trimesh or Open3D is needed to read it for all engines; `pip install trimesh`")
    if not len(triangles):
        raise InputError(f"{path}: no triangles were found in it")
    low, high = np.min(vertices, axis=0), np.max(vertices, axis=0)
    middle = (low + high) / 2
    eye = middle + 1.1 * np.linalg.norm(high - low) * np.array([0.4, 0.3, 0.87])
    camera = Camera(eye.tolist(), middle.tolist(), (0, 1, 0), 50)
    return Mesh(file.name, np.asarray(vertices, np.float32), np.asarray(triangles, np.int32), camera)


def make_rays(mesh: Mesh, scene: Scene, name: str, n: int) -> Query:
    """So many rays of a class: a camera's, what scatters where those hit, or from anywhere to anywhere.

    t_max is about the median of what the rays hit, so that occlusion rays are about as often free as not.
    """
    random = np.random.default_rng(CLASSES.index(name))
    if name == "random":
        ends = random.uniform(*mesh.ends, (2, n, 3))
        origins, directions = ends[0], ends[1] - ends[0]
    else:
        side = math.ceil(math.sqrt(n))
        rays = pinhole_rays(mesh.camera, side, side, dtype=np.float64)
        origins, directions = (np.ascontiguousarray(part.reshape(-1, 3)[:n]) for part in rays)
        if name == "diffuse":
            hits = scene.closest_hit(origins, directions)
            if not hits.hit.any():
                raise InputError(f"{mesh.name}: its camera sees nothing of it")
            seen = np.resize(np.flatnonzero(hits.hit), n)  # in the order of the primary rays
            normals = hits.normal[seen]
            normals = np.where((normals * directions[seen]).sum(-1, keepdims=True) > 0, -normals, normals)
            around = random.normal(size=(n, 3))
            directions = normals + 0.999 * around / np.linalg.norm(around, axis=1, keepdims=True)
            origins = hits.point[seen] + normals * mesh.size * 2**-16
    directions = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    query = Query(np.ascontiguousarray(origins, np.float32), np.ascontiguousarray(directions, np.float32))
    t = scene.closest_hit(query.origins, query.directions, fields=["t"]).t
    hit = t[t < np.inf]
    # A little more, since the ray that is hit just there would be a matter of rounding.
    return Query(query.origins, query.directions, float(np.float32(1.001 * np.median(hit))) if len(hit) else 1.0)


def make_points(mesh: Mesh, n: int) -> Query:
    """So many points in the mesh's box, and a little around it."""
    low, high = mesh.ends
    margin = 0.05 * (high - low)
    return Query(np.random.default_rng(9).uniform(low - margin, high + margin, (n, 3)).astype(np.float32))


# ---- Who traces it


@dataclass
class Answer:
    """What is compared: t or distances (bool: occlusion), and which triangle."""

    values: Array
    primitive: Array | None = None


class Engine:
    """`prepare` lays a query out as the engine wants it, `run` is timed, `answer` is for comparing."""

    name = ""
    tasks: tuple[str, ...] = TASKS

    def __init__(self, mesh: Mesh, threads: int) -> None:
        self.threads = threads

    def prepare(self, task: str, query: Query) -> Any:
        """The query in the engine's own layout."""
        raise NotImplementedError

    def run(self, task: str, given: Any) -> Any:
        """From NumPy arrays to NumPy arrays."""
        raise NotImplementedError

    def answer(self, task: str, query: Query, result: Any) -> Answer:
        """What `run` returned, to compare it."""
        raise NotImplementedError


class Kdray(Engine):
    """kdray, with what Open3D answers too: t, ids, u, v and the normal."""

    name = "kdray"
    fields = ("t", "geometry", "primitive", "u", "v", "normal")

    def __init__(self, mesh: Mesh, threads: int) -> None:
        super().__init__(mesh, threads)
        self.scene = Scene(compute_units=0 if threads == _cores() else threads)
        self.scene.add_mesh(mesh.vertices, mesh.triangles)
        self.scene.commit()

    def prepare(self, task: str, query: Query) -> Any:  # noqa: D102
        return query

    def run(self, task: str, given: Any) -> Any:  # noqa: D102
        if task == "closest":
            return self.scene.closest_hit(given.origins, given.directions, fields=self.fields)
        if task == "occlusion":
            return self.scene.any_hit(given.origins, given.directions, t_max=given.t_max)
        if task == "closest-point":
            return self.scene.closest_point(given.origins)
        return self.scene.signed_distance(given.origins)

    def answer(self, task: str, query: Query, result: Any) -> Answer:  # noqa: D102
        if task == "closest":
            return Answer(result.t, result.primitive)
        return Answer(result.distance if task == "closest-point" else result)


class Embreex(Engine):
    """embreex by itself: it traces rays one by one, in one thread."""

    name = "embreex"
    tasks = RAY_TASKS

    def __init__(self, mesh: Mesh, threads: int) -> None:
        super().__init__(mesh, 1)
        self.scene = importlib.import_module("embreex.rtcore_scene").EmbreeScene()
        importlib.import_module("embreex.mesh_construction").TriangleMesh(self.scene, mesh.vertices, mesh.triangles)

    def prepare(self, task: str, query: Query) -> Any:  # noqa: D102
        return query.origins, query.directions, np.full(len(query), query.t_max, np.float32)

    def run(self, task: str, given: Any) -> Any:  # noqa: D102
        if task == "closest":
            return self.scene.run(given[0], given[1], output=True)
        return self.scene.run(*given, query="OCCLUDED") != -1

    def answer(self, task: str, query: Query, result: Any) -> Answer:  # noqa: D102
        if task == "occlusion":
            return Answer(result)
        return Answer(np.where(result["primID"] >= 0, result["tfar"], np.inf), result["primID"])


class Trimesh(Engine):
    """embreex under trimesh, in one thread; its occlusion has no t_max, so it isn't asked for it."""

    name = "trimesh"
    tasks = ("closest",)

    def __init__(self, mesh: Mesh, threads: int) -> None:
        super().__init__(mesh, 1)
        made = importlib.import_module("trimesh").Trimesh(mesh.vertices, mesh.triangles, process=False)
        self.rays = importlib.import_module("trimesh.ray.ray_pyembree").RayMeshIntersector(made)

    def prepare(self, task: str, query: Query) -> Any:  # noqa: D102
        return query.origins.astype(np.float64), np.asarray(query.directions, np.float64)

    def run(self, task: str, given: Any) -> Any:  # noqa: D102
        return self.rays.intersects_location(*given, multiple_hits=False)

    def answer(self, task: str, query: Query, result: Any) -> Answer:  # noqa: D102
        points, ray, triangle = result
        t, primitive = np.full(len(query), np.inf), np.full(len(query), -1)
        t[ray] = np.linalg.norm(points - query.origins[ray], axis=1)  # directions are of unit length
        primitive[ray] = triangle
        return Answer(t, primitive)


class Open3D(Engine):
    """Open3D's RaycastingScene: Embree's robust mode, in as many threads as kdray."""

    name = "open3d"

    def __init__(self, mesh: Mesh, threads: int) -> None:
        super().__init__(mesh, threads)
        open3d = importlib.import_module("open3d")
        self.tensor = open3d.core.Tensor.from_numpy
        self.scene = open3d.t.geometry.RaycastingScene(nthreads=threads)
        self.scene.add_triangles(self.tensor(mesh.vertices), self.tensor(mesh.triangles.astype(np.uint32)))

    def prepare(self, task: str, query: Query) -> Any:  # noqa: D102
        if query.directions is None:
            return np.ascontiguousarray(query.origins), math.inf
        return np.concatenate([query.origins, query.directions], axis=1), query.t_max

    def run(self, task: str, given: Any) -> Any:  # noqa: D102
        rows, t_max = given
        tensor = self.tensor(rows)
        if task == "closest":
            return {name: a.numpy() for name, a in self.scene.cast_rays(tensor, nthreads=self.threads).items()}
        if task == "occlusion":
            return self.scene.test_occlusions(tensor, tfar=t_max, nthreads=self.threads).numpy()
        if task == "closest-point":
            found = self.scene.compute_closest_points(tensor, nthreads=self.threads)
            return {name: a.numpy() for name, a in found.items()}
        return self.scene.compute_signed_distance(tensor, nthreads=self.threads).numpy()

    def answer(self, task: str, query: Query, result: Any) -> Answer:  # noqa: D102
        if task == "closest":
            missed = result["primitive_ids"] == self.scene.INVALID_ID
            return Answer(result["t_hit"], np.where(missed, -1, result["primitive_ids"].astype(np.int64)))
        if task == "closest-point":
            return Answer(np.linalg.norm(result["points"] - query.origins, axis=1))
        return Answer(result)


KINDS: dict[str, type[Engine]] = {kind.name: kind for kind in (Kdray, Embreex, Trimesh, Open3D)}
NEEDS = {"kdray": (), "embreex": ("embreex",), "trimesh": ("trimesh", "embreex"), "open3d": ("open3d",)}


def different(ours: Answer, theirs: Answer, size: float) -> int:
    """How many answers differ.

    Of rays: only one of the two hits, or they hit different triangles at distances that differ by more than
    1e-4 of themselves (on a common edge, both are right). Of points: distances that differ by more than 1e-5
    of the scene's size.
    """
    a, b = ours.values, theirs.values
    if a.dtype == np.bool_:
        return int(np.count_nonzero(a != b))
    if ours.primitive is None or theirs.primitive is None:
        return int(np.count_nonzero(~(np.abs(a.astype(np.float64) - b) <= 1e-5 * size)))
    both = np.isfinite(a) & np.isfinite(b)
    apart = np.zeros(len(a), np.bool_)
    apart[both] = np.abs(a[both].astype(np.float64) - b[both]) > 1e-4 * np.abs(a[both])
    return int(np.count_nonzero((np.isfinite(a) != np.isfinite(b)) | (apart & (ours.primitive != theirs.primitive))))


# ---- Measuring


@dataclass
class Row:
    """One engine's times for one kind of question."""

    scene: str
    triangles: int
    task: str
    rays: str  # the class, or "points"
    batch: int
    calls: int
    engine: str
    threads: int
    seconds: list[float] = field(default_factory=list)  # of each round, all calls together
    cpu_seconds: list[float] = field(default_factory=list)  # of the same, over all threads
    times_kdray: float | None = None  # its median over that of kdray in as many threads
    cpu_times_kdray: float | None = None
    different: int | None = None  # answers, of `batch`; of the largest batch only

    @property
    def question(self) -> tuple[str, str, str]:
        """What all engines are asked."""
        return self.scene, self.task, self.rays

    @property
    def median(self) -> float:
        """Seconds for a call."""
        return statistics.median(self.seconds) / self.calls

    @property
    def cpu_median(self) -> float:
        """Seconds for a call, over all threads; above 0, whatever the clock's steps are."""
        return max(statistics.median(self.cpu_seconds), 1e-9) / self.calls

    @property
    def per_second(self) -> float:
        """Rays or points."""
        return self.batch / self.median


def measure(
    mesh: Mesh,
    engines: Sequence[Engine],
    task: str,
    name: str,
    query: Query,
    batch: int,
    rounds: int,
    compare: bool,
) -> list[Row]:
    """Times of all engines that know the task, in turns."""
    calls = max(1, min(len(query) // batch, 200 if batch < 100 else 20, 2_000_000 // batch))
    starts = np.linspace(0, len(query) - batch, calls).astype(int)
    parts = [query.part(start, start + batch) for start in starts]
    those = [engine for engine in engines if task in engine.tasks]
    given = [[engine.prepare(task, part) for part in parts] for engine in those]
    rows = [Row(mesh.name, len(mesh.triangles), task, name, batch, calls, e.name, e.threads) for e in those]
    ours: Answer | None = None
    for engine, row, mine in zip(those, rows, given, strict=True):  # the first of them is kdray; this warms up, too
        answer = engine.answer(task, parts[0], engine.run(task, mine[0]))
        if ours is None:
            ours = answer
        elif compare:
            row.different = different(ours, answer, mesh.size)
    for i in range(rounds):
        for k in range(len(those)):
            which = (k + i) % len(those)
            start, cpu = time.perf_counter(), time.process_time()
            for one in given[which]:
                those[which].run(task, one)
            rows[which].seconds.append(time.perf_counter() - start)
            rows[which].cpu_seconds.append(time.process_time() - cpu)
    base = {row.threads: row for row in rows if row.engine == "kdray"}
    for row in rows:
        if row.threads in base:
            row.times_kdray = row.median / base[row.threads].median
            row.cpu_times_kdray = row.cpu_median / base[row.threads].cpu_median
    return rows


def engines_for(mesh: Mesh, names: Iterable[str], threads: int) -> list[Engine]:
    """The engines, kdray first; it comes in one thread, too, where others have no more."""
    made: list[Engine] = [Kdray(mesh, threads)]
    others = [KINDS[name](mesh, threads) for name in names if name != "kdray"]
    if threads != 1 and any(engine.threads == 1 for engine in others):
        made.append(Kdray(mesh, 1))
    return made + others


def run(
    mesh: Mesh,
    names: Sequence[str],
    tasks: Sequence[str],
    classes: Sequence[str],
    options: argparse.Namespace,
) -> Iterator[list[Row]]:
    """All that is asked of one scene, a question at a time."""
    engines = engines_for(mesh, names, options.threads)
    assert isinstance(engines[0], Kdray)
    kinds = [(name, [t for t in tasks if t in RAY_TASKS]) for name in classes]
    kinds.append(("points", [t for t in tasks if t in POINT_TASKS]))
    for name, asked in kinds:
        if not asked:
            continue
        if name == "points":
            query = make_points(mesh, options.points)
        else:
            query = make_rays(mesh, engines[0].scene, name, options.rays)
        sizes = sorted({min(batch, len(query)) for batch in [*options.batches, len(query)]})
        for task in asked:
            for batch in sizes:
                yield measure(mesh, engines, task, name, query, batch, options.rounds, batch == sizes[-1])


# ---- Telling


def _module(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except Exception:  # whatever keeps it from being imported, it isn't there
        return None


def _cores() -> int:
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1


def _processor() -> str:
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def versions() -> dict[str, str]:
    """Of Python, NumPy, kdray and of the others that are installed."""
    found = {"python": platform.python_version(), "numpy": np.__version__, "kdray": __version__}
    for name in ("embreex", "trimesh", "open3d", "open3d-cpu"):
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return found


HEAD = f"{'engine':<9}{'threads':>8}{'batch':>9}{'a call':>12}{'M/s':>9}{'x kdray':>9}{'x cpu':>8}{'different':>11}"


def _line(row: Row) -> str:
    call = f"{row.median * 1e3:.2f} ms" if row.median >= 1e-3 else f"{row.median * 1e6:.1f} us"
    ratio, cpu = ("-" if x is None else f"{x:.2f}" for x in (row.times_kdray, row.cpu_times_kdray))
    apart = "-" if row.different is None else str(row.different)
    speed = f"{row.per_second / 1e6:.3f}"
    return f"{row.engine:<9}{row.threads:>8}{row.batch:>9}{call:>12}{speed:>9}{ratio:>9}{cpu:>8}{apart:>11}"


COLOURS = {"kdray": "#c2410c", "embreex": "#64748b", "trimesh": "#94a3b8", "open3d": "#0369a1"}


def plot(rows: Sequence[Row], titles: Sequence[str]) -> str:
    """An SVG with a bar for each engine and question, of the largest batch: millions a second."""
    largest: dict[tuple[str, str, str], int] = {}
    for row in rows:
        largest[row.question] = max(row.batch, largest.get(row.question, 0))
    shown = [row for row in rows if row.batch == largest[row.question]]
    y, parts = 44 + 14 * len(titles), []
    for question, batch in largest.items():
        those = [row for row in shown if row.question == question]
        fastest = max(row.per_second for row in those)
        about = _escaped(f"{', '.join(question)}: {batch} at once")
        parts.append(f'<text x="10" y="{y + 12}" font-weight="bold">{about}</text>')
        for row in those:
            y += 17
            wide = 560 * row.per_second / fastest
            who = f"{row.engine}, {row.threads} thread{'s' if row.threads > 1 else ''}"
            parts.append(f'<text x="150" y="{y + 12}" text-anchor="end">{who}</text>')
            parts.append(f'<rect x="156" y="{y + 2}" width="{wide:.1f}" height="13" fill="{COLOURS[row.engine]}"/>')
            parts.append(f'<text x="{160 + wide:.1f}" y="{y + 12}">{row.per_second / 1e6:.2f}</text>')
        y += 28
    head = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="780" height="{y}"',
        ' font-family="sans-serif" font-size="11">',
        '<rect width="100%" height="100%" fill="white"/>',
        '<text x="10" y="20" font-size="14">Million rays or points a second</text>',
        *(f'<text x="10" y="{36 + 14 * i}" fill="#555">{_escaped(t)}</text>' for i, t in enumerate(titles)),
    ]
    return "\n".join([*head, *parts, "</svg>", ""])


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")


# ---- The command line


def _some_of(all_: Sequence[str]) -> Callable[[str], list[str]]:
    def read_them(text: str) -> list[str]:
        names = text.split(",")
        for name in names:
            if name not in all_:
                raise argparse.ArgumentTypeError(f"there is no {name!r}; there are {', '.join(all_)}")
        return names

    return read_them


def _numbers(text: str) -> list[int]:
    return [_count(part) for part in text.split(",")]


def _count(text: str) -> int:
    try:
        number = int(float(text))  # 1e6, too
    except (ValueError, OverflowError) as why:
        raise argparse.ArgumentTypeError(f"{text!r} is no number") from why
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} is less than 1")
    return number


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m kdray.bench", description=(__doc__ or "").replace("`", ""))
    parser.add_argument("scenes", nargs="*", help="sphere, room (the default: both), or mesh files")
    parser.add_argument("--rays", type=_count, default=1_000_000, metavar="N", help="of each class (1000000)")
    parser.add_argument("--points", type=_count, default=100_000, metavar="N", help="of the others (100000)")
    parser.add_argument(
        "--batches", type=_numbers, default=[1, 1000], metavar="N,N", help="beside all at once (1,1000)"
    )
    parser.add_argument("--rounds", type=_count, default=5, metavar="N", help="the median is reported (5)")
    parser.add_argument("--threads", type=_count, default=_cores(), metavar="N", help="of kdray and Open3D (all cores)")
    parser.add_argument(
        "--classes", type=_some_of(CLASSES), default=list(CLASSES), metavar="NAMES", help=", ".join(CLASSES)
    )
    parser.add_argument("--tasks", type=_some_of(TASKS), default=list(TASKS), metavar="NAMES", help=", ".join(TASKS))
    parser.add_argument("--engines", type=_some_of(ENGINES), metavar="NAMES", help="all that are installed")
    parser.add_argument("--json", metavar="FILE", help="write all figures")
    parser.add_argument("--plot", metavar="FILE.svg", help="write bars of the largest batch")
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Measures and writes a table to stdout; the status: 0, 2 for bad input, 3 without a device, else 1."""
    options = _parser().parse_args(argv)
    try:
        _bench(options)
    except (Error, OSError) as error:
        print(f"kdray bench: {error}", file=sys.stderr)
        return 2 if isinstance(error, InputError) else 3 if isinstance(error, NoDeviceError) else 1
    return 0


def _bench(options: argparse.Namespace) -> None:
    options.threads = min(options.threads, _cores())
    for path in filter(None, (options.json, options.plot)):
        if not pathlib.Path(path).absolute().parent.is_dir():
            raise InputError(f"{path}: there is no such folder")
    names, left_out = [], {}
    for name in options.engines or ENGINES:
        missing = [module for module in NEEDS[name] if _module(module) is None]
        if missing:
            left_out[name] = f"{', '.join(missing)} can't be imported"
        else:
            names.append(name)
    device = next((device.name for device in devices() if device.usable), "")
    about = {
        "processor": _processor(),
        "cores": _cores(),
        "device": device,
        "versions": versions(),
        "left_out": left_out,
        **{name: getattr(options, name) for name in ("threads", "rays", "points", "rounds")},
    }
    titles = _titles(about)
    print("\n".join(titles))
    rows: list[Row] = []
    for scene in options.scenes or BUILT_IN:
        mesh = BUILT_IN[scene]() if scene in BUILT_IN else read(scene)
        for measured in run(mesh, names, options.tasks, options.classes, options):
            _tell(measured, rows[-1] if rows else None)
            rows += measured
    if options.json:
        figures = [asdict(row) | {"median": row.median, "per_second": row.per_second} for row in rows]
        pathlib.Path(options.json).write_text(json.dumps({**about, "rows": figures}, indent=1) + "\n")
    if options.plot:
        pathlib.Path(options.plot).write_text(plot(rows, titles[:2]))


def _titles(about: dict[str, Any]) -> list[str]:
    lines = [
        f"{about['processor']}, {about['threads']} of {about['cores']} cores; kdray on {about['device']}",
        ", ".join(f"{name} {version}" for name, version in about["versions"].items()),
        *(f"left out: {name}: {why}" for name, why in about["left_out"].items()),
    ]
    if "embreex" not in about["left_out"]:
        lines.append("embreex, and trimesh on top of it, trace in one thread: kdray in one thread is beside them")
    return [
        *lines,
        "a call: the median time; x kdray: that over kdray's in as many threads; different: answers unlike kdray's",
        "x cpu: as x kdray, of the processor's time over all threads: others' load moves it less",
    ]


def _tell(measured: Sequence[Row], before: Row | None) -> None:
    first = measured[0]
    if before is None or before.question != first.question:
        print(f"\n{first.scene} ({first.triangles} triangles), {first.task}, {first.rays}\n{HEAD}")
    for row in measured:
        print(_line(row), flush=True)


if __name__ == "__main__":
    sys.exit(main())
