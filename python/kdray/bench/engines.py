"""Who traces it: kdray, Embree, trimesh and Open3D, each in the layout and the precision that it takes."""

from __future__ import annotations

import ctypes
import importlib
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..scene import Scene
from .machine import EMBREE3, cores
from .workload import Array, Mesh, Query

RAY_TASKS = ("closest", "occlusion")
POINT_TASKS = ("closest-point", "signed-distance")
TASKS = (*RAY_TASKS, *POINT_TASKS)
ENGINES = ("kdray", "embreex", "trimesh", "open3d")


@dataclass
class Answer:
    """What is compared: t or distances (bool: occlusion), and which triangle."""

    values: Array
    primitive: Array | None = None


class Engine:
    """`prepare` lays a query out as the engine wants it, `run` is timed, `answer` is for comparing."""

    name = ""
    tasks: tuple[str, ...] = TASKS
    share = 1  # of aimed rays every so manieth is enough: the others are a matter of patience
    dtype: type[np.floating[Any]] = (
        np.float32
    )  # that it computes in: what is given in another is rounded to it before the clock starts

    def __init__(self, mesh: Mesh, threads: int) -> None:
        self.threads = threads
        self.vertices: Array = np.ascontiguousarray(mesh.vertices, self.dtype)

    def prepare(self, task: str, query: Query) -> Any:
        """The query in the engine's own layout."""
        raise NotImplementedError

    def run(self, task: str, given: Any) -> Any:
        """From NumPy arrays to NumPy arrays."""
        raise NotImplementedError

    def answer(self, task: str, query: Query, result: Any) -> Answer:
        """What `run` returned, to compare it."""
        raise NotImplementedError

    def count(self, query: Query) -> Array | None:
        """How many surfaces each ray crosses; None where it is no question of the engine's."""
        return None


class Kdray(Engine):
    """kdray, with what Open3D answers too: t, ids, u, v and the normal."""

    name = "kdray"
    fields = ("t", "geometry", "primitive", "u", "v", "normal")
    geometry = "float"

    def __init__(self, mesh: Mesh, threads: int) -> None:
        super().__init__(mesh, threads)
        self.scene = Scene(compute_units=0 if threads == cores() else threads, geometry=self.geometry)
        self.scene.add_mesh(self.vertices, mesh.triangles)
        self.scene.commit()

    def prepare(self, task: str, query: Query) -> Any:  # noqa: D102
        return query.of(self.dtype)

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

    def count(self, query: Query) -> Array:  # noqa: D102
        given = query.of(self.dtype)
        return self.scene.count_hits(given.origins, given.directions)


class KdrayDouble(Kdray):
    """kdray's double geometry, which the host traces on all cores."""

    name = "kdray-double"
    geometry = "double"
    dtype = np.float64

    def __init__(self, mesh: Mesh, threads: int) -> None:
        super().__init__(mesh, cores())


class Embreex(Engine):
    """embreex by itself (Embree 4): it traces rays one by one, in one thread."""

    name = "embreex"
    tasks = RAY_TASKS
    robust = False

    def __init__(self, mesh: Mesh, threads: int) -> None:
        super().__init__(mesh, 1)
        self.scene = importlib.import_module("embreex.rtcore_scene").EmbreeScene(robust=self.robust)
        importlib.import_module("embreex.mesh_construction").TriangleMesh(self.scene, self.vertices, mesh.triangles)

    def prepare(self, task: str, query: Query) -> Any:  # noqa: D102
        given = query.of(self.dtype)
        return given.origins, given.directions, np.full(len(query), query.t_max, np.float32)

    def run(self, task: str, given: Any) -> Any:  # noqa: D102
        if task == "closest":
            return self.scene.run(given[0], given[1], output=True)
        return self.scene.run(*given, query="OCCLUDED") != -1

    def answer(self, task: str, query: Query, result: Any) -> Answer:  # noqa: D102
        if task == "occlusion":
            return Answer(result)
        return Answer(np.where(result["primID"] >= 0, result["tfar"], np.inf), result["primID"])


class EmbreexRobust(Embreex):
    """embreex with Embree's robust flag."""

    name = "embreex-robust"
    robust = True


class Embree3(Engine):
    """Embree 3 by its C interface, a stream of rays in one thread: there is no package of it for Python."""

    name = "embree3"
    tasks = ("closest",)
    flags = 0

    def __init__(self, mesh: Mesh, threads: int) -> None:
        super().__init__(mesh, 1)
        self.library = library = ctypes.CDLL(EMBREE3)
        pointer, number, size = ctypes.c_void_p, ctypes.c_uint, ctypes.c_size_t
        library.rtcNewDevice.restype = library.rtcNewScene.restype = library.rtcNewGeometry.restype = pointer
        device = pointer(library.rtcNewDevice(b"threads=1"))
        self.scene = pointer(library.rtcNewScene(device))
        library.rtcSetSceneFlags(self.scene, self.flags)
        geometry = pointer(library.rtcNewGeometry(device, 0))
        padded = np.concatenate([self.vertices, np.zeros((1, 3), np.float32)])  # Embree reads 16 bytes of the last
        self.arrays = np.ascontiguousarray(mesh.triangles, np.uint32), padded
        counts = len(mesh.triangles), len(mesh.vertices)
        for kind, (layout, array, n) in enumerate(zip((0x5003, 0x9003), self.arrays, counts, strict=True)):
            given = number(0), layout, pointer(array.ctypes.data), size(0), size(12), size(n)
            library.rtcSetSharedGeometryBuffer(geometry, kind, *given)
        library.rtcCommitGeometry(geometry)
        library.rtcAttachGeometry(self.scene, geometry)
        library.rtcCommitScene(self.scene)
        self.context = np.array([0, 0, 0, 0, 2**32 - 1, 0], np.uint32)  # no flags, no filter, no instance

    def prepare(self, task: str, query: Query) -> Any:  # noqa: D102
        rows = np.zeros((len(query), 20), np.float32)  # RTCRayHit
        given = query.of(self.dtype)
        rows[:, 0:3], rows[:, 4:7], rows[:, 8] = given.origins, given.directions, np.inf
        rows.view(np.uint32)[:, [9, 17, 18, 19]] = 2**32 - 1  # the mask; nothing is hit
        return rows

    def run(self, task: str, given: Any) -> Any:  # noqa: D102
        rows = given.copy()
        data, context = (ctypes.c_void_p(a.ctypes.data) for a in (rows, self.context))
        self.library.rtcIntersect1M(self.scene, context, data, ctypes.c_uint(len(rows)), ctypes.c_size_t(80))
        return rows

    def answer(self, task: str, query: Query, result: Any) -> Answer:  # noqa: D102
        primitive = result.view(np.int32)[:, 17]
        return Answer(np.where(primitive >= 0, result[:, 8], np.inf), primitive)


class Embree3Robust(Embree3):
    """The same with Embree's robust flag."""

    name = "embree3-robust"
    flags = 4


class Trimesh(Engine):
    """embreex under trimesh, in one thread; its occlusion has no t_max, so it isn't asked for it."""

    name = "trimesh"
    tasks = ("closest",)
    dtype = np.float64
    tracer = "ray_pyembree"

    def __init__(self, mesh: Mesh, threads: int) -> None:
        super().__init__(mesh, 1)
        made = importlib.import_module("trimesh").Trimesh(self.vertices, mesh.triangles, process=False)
        self.rays = importlib.import_module(f"trimesh.ray.{self.tracer}").RayMeshIntersector(made)

    def prepare(self, task: str, query: Query) -> Any:  # noqa: D102
        given = query.of(self.dtype)
        return given.origins, given.directions

    def run(self, task: str, given: Any) -> Any:  # noqa: D102
        return self.rays.intersects_location(*given, multiple_hits=False)

    def answer(self, task: str, query: Query, result: Any) -> Answer:  # noqa: D102
        points, ray, triangle = result
        t, primitive = np.full(len(query), np.inf), np.full(len(query), -1)
        origins, directions = self.prepare(task, query)
        along = directions[ray]
        t[ray] = np.einsum("ij,ij->i", points - origins[ray], along) / np.einsum("ij,ij->i", along, along)
        primitive[ray] = triangle
        return Answer(t, primitive)

    def count(self, query: Query) -> Array:  # noqa: D102
        _, ray, _ = self.rays.intersects_location(*self.prepare("closest", query))
        return np.bincount(ray, minlength=len(query))


class TrimeshOwn(Trimesh):
    """trimesh's own tracer, in NumPy over an R-tree; repeated hits are merged, as for counting they have to be.

    It is given some rays at a time, since it holds each with all triangles whose boxes the ray passes.
    """

    name = "trimesh-own"
    tracer = "ray_triangle"
    at_once = 500
    share = 10

    def _in_parts(self, given: Any, multiple_hits: bool) -> tuple[Array, ...]:
        found = []
        for first in range(0, len(given[0]), self.at_once):
            part = (a[first : first + self.at_once] for a in given)
            points, ray, triangle = self.rays.intersects_location(*part, multiple_hits=multiple_hits)
            found.append((np.reshape(points, (-1, 3)), ray + first, triangle))
        return tuple(np.concatenate(column) for column in zip(*found, strict=True))

    def run(self, task: str, given: Any) -> Any:  # noqa: D102
        return self._in_parts(given, multiple_hits=False)

    def count(self, query: Query) -> Array:  # noqa: D102
        return np.bincount(self._in_parts(self.prepare("closest", query), True)[1], minlength=len(query))


class Open3D(Engine):
    """Open3D's RaycastingScene: Embree's robust mode, in as many threads as kdray."""

    name = "open3d"

    def __init__(self, mesh: Mesh, threads: int) -> None:
        super().__init__(mesh, threads)
        open3d = importlib.import_module("open3d")
        self.tensor = open3d.core.Tensor.from_numpy
        self.scene = open3d.t.geometry.RaycastingScene(nthreads=threads)
        self.scene.add_triangles(self.tensor(self.vertices), self.tensor(mesh.triangles.astype(np.uint32)))

    def prepare(self, task: str, query: Query) -> Any:  # noqa: D102
        given = query.of(self.dtype)
        if given.directions is None:
            return given.origins, math.inf
        return np.concatenate([given.origins, given.directions], axis=1), query.t_max

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

    def count(self, query: Query) -> Array:  # noqa: D102
        rows, _ = self.prepare("closest", query)
        return np.asarray(self.scene.count_intersections(self.tensor(rows), nthreads=self.threads).numpy())


KINDS: dict[str, type[Engine]] = {
    kind.name: kind
    for kind in (
        Kdray,
        KdrayDouble,
        Embree3,
        Embree3Robust,
        Embreex,
        EmbreexRobust,
        Open3D,
        TrimeshOwn,
        Trimesh,
    )
}
NEEDS: dict[str, tuple[str, ...]] = {
    "kdray": (),
    "kdray-double": (),
    "embree3": (EMBREE3,),
    "embree3-robust": (EMBREE3,),
    "embreex": ("embreex",),
    "embreex-robust": ("embreex",),
    "open3d": ("open3d",),
    "trimesh-own": ("trimesh", "rtree", "scipy"),
    "trimesh": ("trimesh", "embreex"),
}
