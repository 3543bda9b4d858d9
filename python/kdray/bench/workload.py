"""What is traced: meshes, and rays and points about them."""

from __future__ import annotations

import gzip
import lzma
import math
import pathlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import InputError
from ..looks import Camera
from ..rays import pinhole_rays
from ..scene import Scene
from .machine import module

Array = npt.NDArray[Any]

CLASSES = ("primary", "diffuse", "random")


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
        return float(np.linalg.norm(np.subtract(high, low, dtype=np.float64)))


@dataclass(frozen=True)
class Query:
    """Rays (two arrays) or points (one), and how far an occlusion ray goes."""

    origins: Array
    directions: Array | None = None
    t_max: float = math.inf

    def __len__(self) -> int:
        return len(self.origins)

    def part(self, first: int, end: int) -> Query:
        """Rays first to end."""
        directions = None if self.directions is None else self.directions[first:end]
        return Query(self.origins[first:end], directions, self.t_max)

    def every(self, step: int) -> Query:
        """Every so manieth ray."""
        directions = None if self.directions is None else self.directions[::step]
        return Query(self.origins[::step], directions, self.t_max)

    def of(self, dtype: type[np.floating[Any]]) -> Query:
        """The same in that precision."""
        parts = (self.origins, self.directions)
        origins, directions = (a if a is None else np.ascontiguousarray(a, dtype) for a in parts)
        assert origins is not None
        return Query(origins, directions, self.t_max)


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
    trimesh, open3d = module("trimesh"), module("open3d")
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
