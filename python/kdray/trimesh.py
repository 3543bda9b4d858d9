"""kdray as the ray engine of trimesh.

>>> import trimesh
>>> import kdray.trimesh
>>> kdray.trimesh.install()
>>> trimesh.creation.box().ray
<kdray.trimesh.RayMeshIntersector of 12 triangles>

`install` makes ``mesh.ray`` of every mesh that is made from then on kdray's, and with it ``mesh.contains``, trimesh's
own functions that trace rays (voxels, thickness, signed distances) and pyvista's ``multi_ray_trace``. For one mesh
alone: ``mesh.ray = kdray.trimesh.RayMeshIntersector(mesh)``.
"""

from __future__ import annotations

import sys
import threading
import types
from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh
import trimesh.ray.ray_triangle

from ._arrays import ArrayLike, as_array
from .errors import InputError
from .hits import Array
from .scene import Scene

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

# A t_min is left out; this one lets in the hit at t = 0, which trimesh's engines count.
_FROM_ZERO = -1e-30
# By how much of the mesh's size its vertices are moved at most when they become floats, and some.
_ROUNDED = 2.0**-23
# How far a hit may lie from where the mesh's own double triangles have it, in the mesh's size: what comes from float
# vertices is less. Beyond it (rays along a triangle) the plane tells nothing.
_NEAR = 2.0**-17

_ENGINES = "trimesh.ray.ray_pyembree"
_before: tuple[Any, bool, Any, Any] | None = None  # ray_pyembree, has_embree, and the engines of the two modules


class RayMeshIntersector:
    """What trimesh's two engines can be asked, by the same names, answered by kdray.

    A ray that passes through an edge or a vertex crosses the surface once: there are no duplicates to merge, and none
    is lost. Rays go on from hit to hit without an offset and are told apart without a tolerance, at any size of the
    mesh and from any distance. Hits at t = 0 count, as with trimesh's engines. Locations are computed in double from
    the mesh's own vertices.

    Rays are two arrays of the same shape (n, 3), of any numbers, and directions of any length; one that means nothing
    (a NaN, no direction) hits nothing. Results are ordered by ray, and of each ray by distance. A change to the mesh
    is noticed by the next call, which builds the tree anew, or refits it where only vertices moved.
    """

    def __init__(self, mesh: Any = None, scale_to_box: bool = True, *, geometry: Any = None) -> None:
        """`mesh`: a trimesh.Trimesh, by trimesh's other name for it `geometry`.

        `scale_to_box` has no effect: kdray moves and scales what it is given, whatever its size.
        """
        self.mesh = geometry if mesh is None else mesh
        self._forget()

    def _forget(self) -> None:
        self._scene = Scene()
        self._hash: int | None = None  # of the mesh that the scene is of
        self._faces: Ints = np.empty((0, 3), np.int64)
        self._n_vertices = 0
        self._planes: tuple[Floats, Floats] | None = None
        self._lock = threading.Lock()

    # ---- The mesh

    @property
    def scene(self) -> Scene:
        """The scene of the mesh as it is now: primitives have the numbers of its faces."""
        now = hash(self.mesh)
        if now != self._hash:
            with self._lock:
                if now != self._hash:
                    self._follow(np.asarray(self.mesh.vertices, np.float64), np.asarray(self.mesh.faces, np.int64))
                    self._hash = now
        return self._scene

    def _follow(self, vertices: Floats, faces: Ints) -> None:
        self._planes = None
        if len(faces) and self._n_vertices == len(vertices) and np.array_equal(self._faces, faces):
            self._scene.update_vertices(0, vertices)
            self._scene.commit()
            return
        scene = Scene()
        scene.add_mesh(vertices, faces)
        scene.commit()
        self._scene, self._faces, self._n_vertices = scene, faces.copy(), len(vertices)

    def _planes_of_faces(self) -> tuple[Floats, Floats]:
        """A point and the normal, of no certain length, of each face."""
        planes = self._planes
        if planes is None:
            corners = np.asarray(self.mesh.vertices, np.float64)[np.asarray(self.mesh.faces)]
            a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
            planes = self._planes = (np.ascontiguousarray(a), np.cross(b - a, c - a))
        return planes

    # ---- Rays

    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int | None = None,
        return_locations: bool = False,
    ) -> tuple[Any, ...]:
        """The faces that each ray hits: all, or with ``multiple_hits=False`` the first.

        Returns `index_tri` (h,) int64, the faces; `index_ray` (h,) int64, whose hits they are; with
        `return_locations` also the places (h, 3) float64. `max_hits`: at most so many of each ray, the nearest ones;
        None is all.

        With ``multiple_hits=True`` a ray that only touches a convex edge from outside doesn't cross the surface; with
        False it hits it.
        """
        origins, directions = _rays(ray_origins, ray_directions)
        scene = self.scene
        t: Floats
        if multiple_hits:
            hits = scene.all_hits(origins, directions, self._from_zero(directions), max_hits=max_hits)
            index_tri, index_ray, t = hits.primitive.astype(np.int64), hits.ray, hits.t
        else:
            fields = ("primitive", "t") if return_locations else ("primitive",)
            first = scene.closest_hit(origins, directions, t_min=_FROM_ZERO, fields=fields)
            index_ray = np.flatnonzero(first.primitive >= 0)
            index_tri = first.primitive[index_ray].astype(np.int64)
            t = first.t[index_ray] if return_locations else np.empty(0)
        if not return_locations:
            return index_tri, index_ray
        return index_tri, index_ray, self._places(origins[index_ray], directions[index_ray], index_tri, t)

    def _from_zero(self, directions: Floats) -> Floats:
        """A t_min for each ray that lets in the surface that it begins on, whose float vertices may lie behind it."""
        length = np.sqrt(np.einsum("ij,ij->i", directions, directions))
        with np.errstate(divide="ignore", invalid="ignore"):
            t_min: Floats = np.where(length > 0, -_ROUNDED * float(self.mesh.scale) / length, 0)
        return np.maximum(t_min, -np.finfo(np.float64).max)

    def _places(self, origins: Floats, directions: Floats, faces: Ints, t: Floats) -> Floats:
        """Where the rays meet the planes of the faces, which the scene knows with float vertices only."""
        if len(faces) == 0:
            return np.empty((0, 3))
        points, normals = self._planes_of_faces()
        normal = normals[faces]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            exact: Floats = np.einsum("ij,ij->i", points[faces] - origins, normal)
            exact /= np.einsum("ij,ij->i", directions, normal)
            length = np.sqrt(np.einsum("ij,ij->i", directions, directions))
            good = np.abs(exact - t) * length <= _NEAR * float(self.mesh.scale)
        result: Floats = origins + np.where(good, exact, t)[:, None] * directions
        return result

    def intersects_location(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int | None = None,
    ) -> tuple[Floats, Ints, Ints]:
        """The places (h, 3) float64 where rays hit, `index_ray` (h,) and `index_tri` (h,) int64."""
        index_tri, index_ray, locations = self.intersects_id(
            ray_origins, ray_directions, multiple_hits=multiple_hits, max_hits=max_hits, return_locations=True
        )
        return locations, index_ray, index_tri

    def intersects_first(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> Ints:
        """(n,) int64: the face that each ray hits first, or -1."""
        origins, directions = _rays(ray_origins, ray_directions)
        first = self.scene.closest_hit(origins, directions, t_min=_FROM_ZERO, fields=("primitive",))
        return np.asarray(first.primitive, np.int64)

    def intersects_any(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> npt.NDArray[np.bool_]:
        """(n,) bool: whether each ray hits anything."""
        return self.scene.any_hit(*_rays(ray_origins, ray_directions), t_min=_FROM_ZERO)

    def contains_points(self, points: ArrayLike) -> npt.NDArray[np.bool_]:
        """(n,) bool: whether each of the points (n, 3) lies inside of the mesh, which is to be closed.

        It does where a ray from it crosses the surface an odd number of times; crossings are exact, so there is no
        second ray, no vote and no random direction.
        """
        return self.scene.contains(_rows(points, "points"))

    # ---- Copies: of the mesh alone

    def __getstate__(self) -> dict[str, Any]:
        return {"mesh": self.mesh}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.mesh = state["mesh"]
        self._forget()

    def __copy__(self) -> RayMeshIntersector:
        return type(self)(self.mesh)

    def __deepcopy__(self, memo: dict[int, Any]) -> RayMeshIntersector:
        return type(self)(self.mesh)

    def __repr__(self) -> str:
        return f"<kdray.trimesh.RayMeshIntersector of {len(self.mesh.faces)} triangles>"


def install() -> None:
    """Makes kdray trimesh's ray engine: ``mesh.ray`` of all meshes made from now on, ``use_embree`` or not.

    Both of trimesh's engines are replaced where trimesh looks for them, ``trimesh.ray.ray_triangle`` and
    ``trimesh.ray.ray_pyembree`` (which is there then without embreex, and ``trimesh.ray.has_embree`` is True, which
    pyvista asks). Meshes made before keep theirs: ``mesh.ray = kdray.trimesh.RayMeshIntersector(mesh)`` changes it.
    Doing it twice does nothing more.
    """
    global _before
    if _before is not None:
        return
    ray: Any = trimesh.ray
    embree: Any = ray.ray_pyembree if ray.has_embree else None
    _before = (
        ray.ray_pyembree,
        ray.has_embree,
        ray.ray_triangle.RayMeshIntersector,
        embree.RayMeshIntersector if embree is not None else None,
    )
    if embree is None:
        embree = sys.modules[_ENGINES] = types.ModuleType(_ENGINES, "kdray in embreex's place.")
    embree.RayMeshIntersector = ray.ray_triangle.RayMeshIntersector = RayMeshIntersector
    ray.ray_pyembree, ray.has_embree = embree, True


def uninstall() -> None:
    """Gives meshes made from now on trimesh's own engines again; others keep kdray's."""
    global _before
    if _before is None:
        return
    ray: Any = trimesh.ray
    ray.ray_pyembree, ray.has_embree, ray.ray_triangle.RayMeshIntersector, own = _before
    if own is not None:
        ray.ray_pyembree.RayMeshIntersector = own
    else:
        sys.modules.pop(_ENGINES, None)
    _before = None


def _rows(values: ArrayLike, name: str) -> Array:
    array = np.asarray(as_array(values, name))
    if array.size == 0 and array.ndim < 2:
        return np.empty((0, 3))
    if array.ndim != 2 or array.shape[1] != 3:
        raise InputError(f"{name}: the shape is to be (n, 3), not {array.shape}")
    try:
        return np.asarray(array, np.float64)
    except (TypeError, ValueError) as why:
        raise InputError(f"{name}: numbers are wanted, not {array.dtype}") from why


def _rays(ray_origins: ArrayLike, ray_directions: ArrayLike) -> tuple[Floats, Floats]:
    origins, directions = _rows(ray_origins, "ray_origins"), _rows(ray_directions, "ray_directions")
    if origins.shape != directions.shape:
        raise InputError(f"ray_directions has shape {directions.shape} where ray_origins has {origins.shape}")
    return origins, directions
