"""A campaign: random scenes, and whatever kdray answers wrongly about one; a folder is its ledger.

A unit is a seed, which its scene, scale and rays come from. `kdray verify` traces the scene by every walk. Then rays
that begin outside are put to it by each form of question, of floats and of doubles: the forms have to agree, and
counts to be even where surfaces are closed. Others begin on meshes (`leaving`). Of meshes of doubles a sample is held
against exact arithmetic.

The ledger has a file for each unit: whoever creates it, empty, takes the unit, and replaces it by a line of JSON when
that is finished. So any number of processes share a folder, and a run goes on where another ended.
"""

from __future__ import annotations

import json
import os
import pathlib
import subprocess
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import _drivers
from ..devices import devices
from ..looks import Camera
from ..scene import Scene, load
from . import leaving
from .aimed import Right, aim, in_doubles
from .engines import Answer
from .machine import processor
from .meshes import cube, nested, octahedron
from .workload import Array, Mesh, Query, room, sphere

SAMPLE = 40  # rays of a unit that are held against exact arithmetic
GIVEN_UP = 3600  # seconds after which a unit that isn't finished is free again
VERIFIED = ("leaks", "lost_hits", "self_hits", "hits_behind", "disagreements", "nan", "film_not_finite")

Random = np.random.Generator


def _crumpled(random: Random) -> tuple[Array, Array]:
    mesh = sphere(int(random.integers(6, 40)))
    return mesh.vertices * random.uniform(0.6, 1.4, (len(mesh.vertices), 1)), mesh.triangles


def _slivers(random: Random) -> tuple[Array, Array]:
    vertices, triangles = _crumpled(random)
    return vertices * 2.0 ** -random.uniform([0, 0, 8], [0, 8, 20]), triangles


def _lattice(random: Random) -> tuple[Array, Array]:
    return (cube, octahedron)[random.integers(2)](int(random.integers(1, 13)))


def _nested(random: Random) -> tuple[Array, Array]:
    return nested((np.arange(random.integers(2, 12), 0, -1) / 4).tolist(), int(random.integers(1, 4)))


def _boxes(random: Random) -> tuple[Array, Array]:
    mesh = room(int(random.integers(10, 300)))
    return mesh.vertices, mesh.triangles


MESHES: dict[str, Callable[[Random], tuple[Array, Array]]] = {
    "crumpled": _crumpled,
    "slivers": _slivers,
    "lattice": _lattice,
    "nested": _nested,
    "boxes": _boxes,
}


@dataclass
class Unit:
    """A scene file's objects, their mesh if they are one, rays that begin outside, and whether all of it is closed."""

    seed: int
    name: str
    scale: float
    objects: list[dict[str, Any]]
    mesh: Mesh | None
    rays: Query
    closed: bool


def make(seed: int, rays: int, files: Sequence[Mesh] = ()) -> Unit:
    """The unit of a seed: kinds of scenes take turns, sizes are from 1e-30 to 1e30."""
    random = np.random.default_rng(seed)
    names = [*MESHES, "shapes", *(mesh.name for mesh in files)]
    name, scale = names[seed % len(names)], float(10 ** random.uniform(-30, 30))
    if name == "shapes":
        return Unit(seed, name, scale, *_shapes(random, scale, rays))
    given = files[names.index(name) - len(MESHES) - 1] if name not in MESHES else None
    vertices, triangles = (given.vertices, given.triangles) if given else MESHES[name](random)
    away = random.normal(size=3) * 10 ** random.uniform(-3, 3)
    mesh = Mesh(name, ((vertices + away) * scale).astype(np.float32), triangles, Camera((0, 0, 1)))
    if seed // len(names) % 2:
        mesh = in_doubles(mesh, seed)
    aimed = aim(mesh, rays // 4, seed)
    assert aimed.directions is not None
    outside = aimed.origins - 4 * mesh.size * aimed.directions.astype(np.float64)
    objects = [{"type": "triangles", "vertices": mesh.vertices.tolist(), "faces": triangles.tolist()}]
    return Unit(seed, name, scale, objects, mesh, Query(outside, aimed.directions), _closed(triangles))


def _closed(triangles: Array) -> bool:
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    return bool((np.unique(edges, axis=0, return_counts=True)[1] % 2 == 0).all())


def _shapes(random: Random, scale: float, rays: int) -> tuple[list[dict[str, Any]], None, Query, bool]:
    """Spheres alone, or with tori, cones and discs; every other ray touches a ball about a shape's centre."""
    n, kinds = int(random.integers(5, 60)), int(random.integers(1, 5))
    places, axes = random.uniform(-1, 1, (2, n, 3)) * scale
    sizes = random.uniform(0.02, 0.3, n) * scale
    objects = []
    for i, (place, axis, size) in enumerate(zip(places.tolist(), axes.tolist(), sizes.tolist(), strict=True)):
        apex = [p + a / 3 for p, a in zip(place, axis, strict=True)]
        shapes: list[dict[str, Any]] = [
            {"type": "sphere", "center": place, "radius": size},
            {"type": "torus", "center": place, "axis": axis, "major_radius": size, "minor_radius": size / 3},
            {"type": "cone", "base": place, "base_radius": size, "apex": apex, "apex_radius": size / 2},
            {"type": "disc", "center": place, "normal": axis, "radius": size},
        ]
        objects.append(shapes[i % kinds])
    out, along = random.normal(size=(2, rays, 3))
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    along[::2] -= np.einsum("ij,ij->i", along, out)[::2, None] * out[::2]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    which = random.integers(n, size=rays)
    return objects, None, Query(places[which] + sizes[which, None] * out - 8 * scale * along, along), kinds <= 2


def run(unit: Unit) -> dict[str, Any]:
    """The ledger's line: what was asked, and how many answers differ from what they should be, by kind."""
    found: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "unit.json"
        file.write_text(json.dumps({"kdray": 1, "objects": unit.objects}))
        version, traced = _verify(file, len(unit.rays), found)
        kinds: tuple[tuple[str, type[np.floating[Any]]], ...] = ("float", np.float32), ("double", np.float64)
        sampled = 0
        for geometry, dtype in kinds:
            scene = load(file, geometry=geometry)
            _ask(scene, unit.rays.of(dtype), unit.closed, geometry, found)
            traced += 4 * len(unit.rays)
            if unit.mesh is not None:
                asked, judged = leaving.ask(scene, unit, dtype, found)
                traced, sampled = traced + asked, sampled + judged
        if unit.mesh is not None:
            sampled += _hold_against_exact(scene, unit.mesh, unit.seed, found)
    device = next((d.name for d in devices() if d.usable), "")
    about = {"unit": unit.seed, "kdray": version, "device": device, "processor": processor(), "scene": unit.name}
    return {
        **about,
        "scale": unit.scale,
        "doubles": unit.mesh is not None and unit.mesh.vertices.dtype == np.float64,
        "primitives": len(unit.objects) if unit.mesh is None else len(unit.mesh.triangles),
        "rays": traced,
        "exact": sampled,
        "differences": {name: n for name, n in found.items() if n},
    }


def _verify(file: pathlib.Path, rays: int, found: Counter[str]) -> tuple[str, int]:
    """The version, and how many rays the five walks had."""
    _drivers.choose()
    command = [str(_drivers.program()), "verify", str(file), "--rays", str(rays), "--stats", "-", "--quiet"]
    told = subprocess.run(command, capture_output=True, text=True, check=False)
    try:
        stats = json.loads(told.stdout)
    except ValueError:
        found[f"verify: status {told.returncode}: {told.stderr.strip()[-200:]}"] += 1
        return "", 0
    tracing = stats["tracing"]
    found.update(
        {f"verify: {name}": tracing[name] for name in VERIFIED} | {"verify: film": bool(tracing["film_fault"])}
    )
    return stats["kdray"], 5 * sum(tracing[f"rays_{of}"] for of in ("from_inside", "from_outside", "leaving_hits"))


def _ask(scene: Scene, rays: Query, closed: bool, geometry: str, found: Counter[str]) -> None:
    """Four forms of one question have to agree."""
    assert rays.directions is not None
    given = rays.origins, rays.directions
    closest, any_hit, count, every = (
        scene.closest_hit(*given, fields=["t", "primitive"]),
        scene.any_hit(*given),
        scene.count_hits(*given).astype(np.int64),
        scene.all_hits(*given),
    )
    hit, splits = closest.t < np.inf, every.splits
    met = np.diff(splits) > 0
    first = splits[:-1][met]
    wrong = {
        "odd": closed and np.count_nonzero(count % 2),
        "any": np.count_nonzero(any_hit != hit),
        "count": np.count_nonzero((count > 0) & ~hit),
        "all": np.count_nonzero(np.diff(splits) != count),
        "unsorted": np.count_nonzero(
            (np.diff(every.t) < 0) & (np.diff(np.repeat(np.arange(len(count)), np.diff(splits))) == 0)
        ),
    }
    if geometry == "double":  # of floats `all_hits` finds t anew
        wrong["first of all"] = np.count_nonzero(every.t[first] != closest.t[met])
    found.update({f"{geometry}: {name}": int(n) for name, n in wrong.items()})


def _hold_against_exact(scene: Scene, mesh: Mesh, seed: int, found: Counter[str]) -> int:
    """A sample of aimed rays, put to doubles; how many of it have one answer."""
    query = aim(mesh, SAMPLE // 4, seed + 1).of(np.float64)
    assert query.directions is not None
    hits = scene.closest_hit(query.origins, query.directions)
    count = scene.count_hits(query.origins, query.directions).astype(np.int64)
    judged = Right(mesh, query).judge(Answer(hits.t, hits.primitive), count)
    for name in ("lost", "false", "other", "parity"):
        found[f"exact: {name}"] += sum(judged[name])
    found["exact: t"] += bool(judged["t_off"] and judged["t_off"]["largest"] > leaving.LAST_PLACES)
    return int(judged["judged"])


# ---- The ledger


def ledger(folder: pathlib.Path) -> Iterator[dict[str, Any]]:
    """The finished units; what is damaged is none."""
    for file in sorted(folder.glob("unit-*.json")):
        record = _read(file)
        if record:
            yield record


def _read(file: pathlib.Path) -> dict[str, Any] | None:
    """A unit's line; empty where it is taken or was free a moment ago, None where it is no line of a ledger."""
    try:
        text = file.read_text()
        record = json.loads(text) if text else {}
    except FileNotFoundError:
        return {}
    except ValueError:
        return None
    if record == {}:
        return {}
    kinds = {"unit": int, "rays": int, "exact": int, "kdray": str, "device": str, "differences": dict}
    whole = isinstance(record, dict) and all(isinstance(record.get(name), kind) for name, kind in kinds.items())
    return record if whole and all(isinstance(n, int) for n in record["differences"].values()) else None


def _age(file: pathlib.Path) -> float:
    """In seconds; 0 where another process has just given it back."""
    try:
        return time.time() - file.stat().st_mtime
    except FileNotFoundError:
        return 0


def take(folder: pathlib.Path, first: int = 0) -> pathlib.Path:
    """Takes the next unit that is neither finished nor in work."""
    seed = first
    while True:
        file = folder / f"unit-{seed:08}.json"
        try:
            file.touch(exist_ok=False)
            return file
        except FileExistsError:
            record = _read(file)
            if record is None:
                print(f"{file}: damaged; the unit is run again")
            if record is None or (record == {} and _age(file) > GIVEN_UP):
                file.unlink(missing_ok=True)
            else:
                seed += 1


def go_on(folder: pathlib.Path, units: int, rays: int, files: Sequence[Mesh] = (), first: int = 0) -> int:
    """Runs so many units more, of those from `first` on, and returns how many of them have differences."""
    folder.mkdir(parents=True, exist_ok=True)
    seed, bad = first, 0
    for _ in range(units):
        file = take(folder, seed)
        seed = int(file.stem.removeprefix("unit-"))
        try:
            record = run(make(seed, rays, files))
            written = file.with_suffix(f".{os.getpid()}")
            written.write_text(json.dumps(record) + "\n")
            written.replace(file)
        except BaseException:  # Ctrl-C, too: the unit is free again
            file.unlink(missing_ok=True)
            raise
        bad += bool(record["differences"])
        what = ", ".join(f"{n} {name}" for name, n in record["differences"].items()) or "no difference"
        print(f"unit {seed}: {record['scene']} at {record['scale']:.0e}, {record['rays']} rays: {what}", flush=True)
    return bad


def totals(folder: pathlib.Path) -> str:
    """The ledger in a line."""
    records = list(ledger(folder))
    differences: Counter[str] = Counter()
    for record in records:
        differences.update(record["differences"])
    rays, exact = (sum(record[name] for record in records) for name in ("rays", "exact"))
    what = ", ".join(f"{n} {name}" for name, n in differences.items()) or "no difference"
    by = ", ".join(sorted({f"kdray {record['kdray']} on {record['device']}" for record in records}))
    return f"{len(records)} units, {rays} rays, {exact} more held against exact arithmetic: {what} ({by})"
