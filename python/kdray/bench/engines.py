"""Who traces it: kdray, embreex, trimesh and Open3D, each in the layout that it takes."""

from __future__ import annotations

import importlib
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..scene import Scene
from .machine import cores
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
        self.scene = Scene(compute_units=0 if threads == cores() else threads)
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
