"""`RaycastingScene`: kdray by the names of Open3D's class."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable
from typing import Any, overload

import numpy as np
import numpy.typing as npt

from ._arrays import Array, ArrayLike, RayArrays, as_array, vectors
from .errors import InputError, UsageError
from .scene import Scene

# A t_min is left out; this one lets in the hit at t = 0, as Open3D does.
_FROM_ZERO = np.array([-1e-30], np.float32)

_CAST = ("t_hit", "geometry_ids", "primitive_ids", "primitive_uvs", "primitive_normals")
_NEAREST = ("points", "geometry_ids", "primitive_ids", "primitive_uvs", "primitive_normals")


class Answer(np.ndarray[Any, np.dtype[Any]]):
    """An array with the two methods by which the answers of Open3D, which are tensors, become arrays."""

    def cpu(self) -> Answer:
        """Itself."""
        return self

    def numpy(self) -> Array:
        """The plain array, of the same memory."""
        return self.view(np.ndarray)


class RaycastingScene:
    """What ``open3d.t.geometry.RaycastingScene`` (0.20) can be asked, by the same names, answered by kdray.

    >>> import kdray
    >>> scene = kdray.RaycastingScene()
    >>> scene.add_triangles([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    0
    >>> scene.cast_rays([[1, 1, 5, 0, 0, -2]])["t_hit"]
    Answer([2.5], dtype=float32)

    Rays are one array (..., 6) of float32, origin and direction side by side, with one dimension or more before the
    6; points are (..., 3). They are read where they lie. NumPy's arrays, lists and whatever has `__array__` or
    `__dlpack__` are answered with NumPy's arrays, which have the methods `numpy` and `cpu` of Open3D's tensors;
    tensors are answered with tensors on their device. Open3D needn't be installed. `nthreads` has no effect: `device`
    traces, with all its cores.

    Where it differs from Open3D, on purpose:

    - Crossings are exact. A ray through an edge or a vertex crosses the surface once, in `count_intersections`,
      `list_intersections`, `compute_occupancy` and the sign of `compute_signed_distance`, where Open3D counts it
      twice or loses it; so `nsamples` has no effect. One that only touches an edge crosses twice or not at all.
    - Of two triangles at the same distance it is the one with the smaller number that is hit; of two in one place
      whose corners are in another order either may come first, by a rounding.
    - float64 vertices keep what float32 would lose, and rays and points in float64 are answered in float64. (Open3D
      refuses both.) Indices may be of any integer type.
    - Where there is nothing, nearest points and distances are infinite.
    - What is wrong is a `kdray.InputError`.
    """

    #: The id where nothing is hit.
    INVALID_ID = 0xFFFFFFFF

    def __init__(self, nthreads: int = 0, device: Any = "auto") -> None:
        """`device`: as for `kdray.Scene`; one of Open3D's is "auto" if it is a CPU and else "gpu"."""
        if not isinstance(device, (str, int)):
            device = "auto" if str(device).upper().startswith("CPU") else "gpu"
        self._scene = Scene(device=device)
        self._normals: dict[int, tuple[Array, Array]] = {}  # by geometry: vertices, and its triangles' normals

    @property
    def scene(self) -> Scene:
        """The `kdray.Scene` within, with the same ids, for what Open3D's class can't do: move vertices, hide meshes."""
        return self._scene

    # ---- Meshes

    @overload
    def add_triangles(self, vertex_positions: ArrayLike, triangle_indices: ArrayLike) -> int: ...
    @overload
    def add_triangles(self, mesh: Any) -> int: ...
    def add_triangles(self, *args: Any, **kwargs: Any) -> int:
        """Adds a mesh and returns its geometry id, counted from 0.

        Either `vertex_positions` (n, 3) and `triangle_indices` (m, 3), or `mesh`: one of Open3D's, old or new, or
        anything with `vertices` and `triangles` or `faces`, such as trimesh's. Arrays are copied.
        """
        given = dict(zip(("vertex_positions", "triangle_indices"), args, strict=False)) | kwargs
        if len(args) == 1 and not kwargs:
            given = {"mesh": args[0]}
        if len(args) <= 2 and set(given) == {"mesh"}:
            positions, indices = _mesh_parts(given["mesh"])
        elif len(args) <= 2 and set(given) == {"vertex_positions", "triangle_indices"}:
            positions, indices = given["vertex_positions"], given["triangle_indices"]
        else:
            raise UsageError("add_triangles takes vertex_positions and triangle_indices, or a mesh")
        return self._scene.add_mesh(_own(positions, "vertex_positions"), _own(indices, "triangle_indices"))

    # ---- Rays

    def cast_rays(self, rays: ArrayLike, nthreads: int = 0, *, fields: Iterable[str] = _CAST) -> dict[str, Any]:
        """What each ray hits first.

        Returns a dict of `t_hit` (...) float32, in multiples of the direction, infinite for a miss; `geometry_ids`
        and `primitive_ids` (...) uint32, INVALID_ID for a miss; `primitive_uvs` (..., 2) float32, the weights of the
        triangle's second and third corners; `primitive_normals` (..., 3) float32 of unit length. `fields` (kdray's
        own) names those that are wanted: fewer are faster.
        """
        given, shape = _ray_arrays(rays)
        found = _columns(fields, _CAST, shape, given.dtype)
        if given.n:
            column = _Columns(found, given.n)
            self._scene._ready().closest(
                *given.given(),
                False,
                column("t_hit"),
                column("geometry_ids"),
                column("primitive_ids"),
                column("primitive_uvs", 0),
                column("primitive_uvs", 1),
                column("primitive_normals"),
                None,
            )
        return {name: _like(rays, values) for name, values in found.items()}

    def test_occlusions(self, rays: ArrayLike, tnear: float = 0.0, tfar: float = math.inf, nthreads: int = 0) -> Any:
        """Whether each ray hits anything with tnear <= t <= tfar: (...) bool."""
        first = np.nextafter(np.array([tnear], np.float32), np.float32(-np.inf))
        last = np.nextafter(np.array([tfar], np.float32), np.float32(np.inf))
        given, shape = _ray_arrays(rays, first if tnear else _FROM_ZERO, math.inf if math.isinf(tfar) else last)
        result = np.zeros(shape, np.bool_)
        if given.n and tfar >= tnear:
            self._scene._ready().any(*given.given(), False, result.reshape(-1).view(np.uint8))
        return _like(rays, result)

    def count_intersections(self, rays: ArrayLike, nthreads: int = 0) -> Any:
        """How many surfaces each ray crosses: (...) int32."""
        given, shape = _ray_arrays(rays, 0)
        result = np.zeros(shape, np.int32)
        if given.n:
            self._scene._ready().count(*given.given(), False, result.reshape(-1).view(np.uint32))
        return _like(rays, result)

    def list_intersections(self, rays: ArrayLike, nthreads: int = 0) -> dict[str, Any]:
        """Every crossing of every ray, sorted by t.

        Returns a dict of `ray_splits` (rays + 1,) uint32: the crossings of ray i are those from ``ray_splits[i]`` to
        ``ray_splits[i + 1]``; `ray_ids`, `geometry_ids` and `primitive_ids` (k,) uint32; `t_hit` (k,) float32;
        `primitive_uvs` (k, 2) float32. Rays are numbered in C order.
        """
        given, _ = _ray_arrays(rays, 0)
        hits = self._scene.all_hits(given.origins, given.directions)
        found = {
            "ray_splits": hits.splits.astype(np.uint32),
            "ray_ids": hits.ray.astype(np.uint32),
            "t_hit": hits.t.astype(given.dtype, copy=False),
            "geometry_ids": hits.geometry.view(np.uint32),
            "primitive_ids": hits.primitive.view(np.uint32),
            "primitive_uvs": np.stack([hits.u, hits.v], axis=-1),
        }
        return {name: _like(rays, values) for name, values in found.items()}

    # ---- Points

    def compute_closest_points(
        self, query_points: ArrayLike, nthreads: int = 0, *, fields: Iterable[str] = _NEAREST
    ) -> dict[str, Any]:
        """Of each point (..., 3) the nearest point of any triangle.

        Returns a dict of `points` (..., 3) float32; `geometry_ids` and `primitive_ids` (...) uint32; `primitive_uvs`
        (..., 2) and `primitive_normals` (..., 3) float32, as in `cast_rays`. `fields` (kdray's own) names those that
        are wanted.
        """
        points, shape = _query_points(query_points)
        wanted = list(fields)
        with_normals = "primitive_normals" in wanted
        extra = [name for name in ("geometry_ids", "primitive_ids") if with_normals and name not in wanted]
        found = _columns([*wanted, *extra], _NEAREST, shape, points.dtype)
        if len(points):
            column = _Columns(found, len(points))
            self._scene._ready().closest_points(
                points,
                math.inf,
                False,
                None,
                column("points"),
                column("geometry_ids"),
                column("primitive_ids"),
                column("primitive_uvs", 0),
                column("primitive_uvs", 1),
            )
        if with_normals:
            found["primitive_normals"] = self._normals_of(found["geometry_ids"], found["primitive_ids"], points.dtype)
        return {name: _like(query_points, found[name]) for name in wanted}

    def _normals_of(self, geometries: Array, primitives: Array, dtype: Any) -> Array:
        result = np.zeros((*geometries.shape, 3), dtype)
        for geometry in np.unique(geometries):
            if geometry != self.INVALID_ID and self._scene._added[int(geometry)].kind == "mesh":
                own = geometries == geometry
                result[own] = self._normals_in(int(geometry))[primitives[own]]
        return result

    def _normals_in(self, geometry: int) -> Array:
        """Of each of a mesh's triangles the normal; made when there is need, and again when vertices have moved."""
        vertices, triangles = self._scene._added[geometry].arrays[:2]
        assert vertices is not None and triangles is not None
        known = self._normals.get(geometry)
        if known is not None and known[0] is vertices:
            return known[1]
        a, b, c = (vertices[triangles[:, k]].astype(np.float64) for k in range(3))
        normals = np.cross(b - a, c - a)
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        np.divide(normals, length, out=normals, where=length > 0)
        self._normals[geometry] = vertices, normals
        return normals

    def compute_distance(self, query_points: ArrayLike, nthreads: int = 0) -> Any:
        """The distance of each point (..., 3) to the nearest triangle: (...) float32."""
        points, shape = _query_points(query_points)
        distance = self._scene.closest_point(points, fields=("distance",)).distance
        return _like(query_points, distance.reshape(shape))

    def compute_signed_distance(self, query_points: ArrayLike, nthreads: int = 0, nsamples: int = 1) -> Any:
        """The distance of each point (..., 3) to the nearest triangle, negative inside: (...) float32.

        Inside are the points from which rays cross an odd number of surfaces; `nsamples` is to be odd.
        """
        _check_samples(nsamples)
        points, shape = _query_points(query_points)
        return _like(query_points, self._scene.signed_distance(points).reshape(shape))

    def compute_occupancy(self, query_points: ArrayLike, nthreads: int = 0, nsamples: int = 1) -> Any:
        """Whether each point (..., 3) lies inside, 1 or 0: (...) float32. `nsamples` is to be odd."""
        _check_samples(nsamples)
        points, shape = _query_points(query_points)
        return _like(query_points, self._scene.contains(points).astype(np.float32).reshape(shape))

    # ---- Cameras

    @overload
    @staticmethod
    def create_rays_pinhole(
        intrinsic_matrix: ArrayLike, extrinsic_matrix: ArrayLike, width_px: int, height_px: int
    ) -> Any: ...
    @overload
    @staticmethod
    def create_rays_pinhole(
        fov_deg: float, center: ArrayLike, eye: ArrayLike, up: ArrayLike, width_px: int, height_px: int
    ) -> Any: ...
    @staticmethod
    def create_rays_pinhole(*args: Any, **kwargs: Any) -> Any:
        """The rays through the pixels' centres of a pinhole camera: (height_px, width_px, 6) float32.

        Either by `intrinsic_matrix` (3, 3), upper triangular, and `extrinsic_matrix` (4, 4), from the world to the
        camera; or by `fov_deg`, the horizontal field of view, `center`, the point that is looked at, `eye` and `up`,
        where row 0 is the one *lowest* along `up`, as Open3D has it. Directions reach the plane at distance 1.
        """
        by_matrices = ("intrinsic_matrix", "extrinsic_matrix", "width_px", "height_px")
        by_view = ("fov_deg", "center", "eye", "up", "width_px", "height_px")
        for names in (by_matrices, by_view):
            given = dict(zip(names, args, strict=False)) | kwargs
            if len(args) + len(kwargs) == len(names) and set(given) == set(names):
                break
        else:
            raise UsageError(f"create_rays_pinhole takes {', '.join(by_matrices)}, or {', '.join(by_view)}")
        width, height = int(given["width_px"]), int(given["height_px"])
        if width < 1 or height < 1:
            raise UsageError(f"a picture of {width} x {height} has no pixels")
        if names is by_view:
            axes, eye, inverse = _by_view(given, width, height)
        else:
            axes, eye, inverse = _by_matrices(given)
        to_world = axes.T @ inverse
        x, y = np.arange(width) + 0.5, np.arange(height) + 0.5
        rays = np.empty((height, width, 6), np.float32)
        rays[..., :3] = eye
        by_row = y[:, None, None] * to_world[:, 1] + to_world[:, 2]
        np.add(by_row, x[:, None] * to_world[:, 0], out=rays[..., 3:], casting="same_kind")
        return _like(next((a for a in given.values() if _is_tensor(a)), None), rays)

    def __repr__(self) -> str:
        return f"<kdray.RaycastingScene of {len(self._scene.geometries)} meshes, {self._scene.primitives} triangles>"


# ---- Arrays and tensors


def _is_tensor(values: Any) -> bool:
    open3d = sys.modules.get("open3d")  # there is no tensor before it is imported
    core = getattr(open3d, "core", None)
    return core is not None and isinstance(values, core.Tensor)


def _own(values: ArrayLike, name: str) -> Array:
    """The array of whatever was given, without a copy where that is possible."""
    return np.asarray(values.cpu().numpy()) if _is_tensor(values) else as_array(values, name)


def _like(given: Any, values: Array) -> Any:
    """An answer of the kind of what was given."""
    if not _is_tensor(given):
        return values.view(Answer)
    tensor: Any = sys.modules["open3d"].core.Tensor
    return tensor.from_numpy(np.require(values, requirements=("C", "W"))).to(given.device)


def _floats(values: ArrayLike, name: str, wide: int) -> tuple[Array, tuple[int, ...]]:
    """Rows of `wide` floats: float64 where the array has it, and else float32; and the shape of the rows."""
    array = _own(values, name)
    real = isinstance(values, np.ndarray) or _is_tensor(values)
    if array.dtype.kind not in "fiu":
        raise InputError(f"{name}: numbers are wanted, not {array.dtype}")
    if array.ndim < 2 or array.shape[-1] != wide:
        raise InputError(f"{name}: the shape is to be (..., {wide}) of two dimensions or more, not {array.shape}")
    if not (real and array.dtype.kind == "f"):
        array = array.astype(np.float32)
    return array.reshape(-1, wide), array.shape[:-1]


def _ray_arrays(
    rays: ArrayLike, t_min: ArrayLike = _FROM_ZERO, t_max: ArrayLike = math.inf
) -> tuple[RayArrays, tuple[int, ...]]:
    rows, shape = _floats(rays, "rays", 6)
    return RayArrays(rows[:, :3], rows[:, 3:], t_min, t_max, None), shape


def _query_points(points: ArrayLike) -> tuple[Array, tuple[int, ...]]:
    rows, shape = _floats(points, "query_points", 3)
    return vectors(rows, "query_points")[0], shape


def _columns(fields: Iterable[str], names: tuple[str, ...], shape: tuple[int, ...], dtype: Any) -> dict[str, Array]:
    """Arrays for answers."""
    found: dict[str, Array] = {}
    for name in fields:
        if name not in names:
            raise UsageError(f"there is no field {name!r}; there are {', '.join(names)}")
        if name.endswith("_ids"):
            found[name] = np.empty(shape, np.uint32)
        elif name == "t_hit":
            found[name] = np.empty(shape, dtype)
        elif name == "primitive_uvs":
            found[name] = np.empty((*shape, 2), np.float32)
        else:
            found[name] = np.empty((*shape, 3), dtype)
    return found


class _Columns:
    """The memory of answers as `kdray._core` writes to it; u and v lie side by side."""

    def __init__(self, found: dict[str, Array], n: int) -> None:
        self._found, self._n = found, n

    def __call__(self, name: str, part: int | None = None) -> Array | None:
        if name not in self._found:
            return None
        rows = self._found[name].reshape(self._n, -1)
        if part is not None:
            return rows[:, part]
        return rows if rows.shape[1] > 1 else rows[:, 0]


def _mesh_parts(mesh: Any) -> tuple[Any, Any]:
    """Vertices and triangles of a mesh of Open3D's, old or new, or of trimesh's."""
    try:
        if hasattr(mesh, "vertex") and hasattr(mesh, "triangle"):
            return mesh.vertex["positions"], mesh.triangle["indices"]
    except (KeyError, IndexError, RuntimeError) as why:
        raise InputError(f"the mesh has no vertex positions or no triangle indices: {why}") from why
    for faces in ("triangles", "faces"):
        if hasattr(mesh, "vertices") and hasattr(mesh, faces):
            return mesh.vertices, getattr(mesh, faces)
    raise InputError(f"mesh: a mesh with vertices and triangles is wanted, not {type(mesh).__name__}")


def _check_samples(nsamples: int) -> None:
    if nsamples < 1 or nsamples % 2 == 0:
        raise UsageError(f"nsamples is to be odd, not {nsamples}")


# ---- Cameras

Doubles = npt.NDArray[np.float64]


def _numbers(given: dict[str, Any], name: str, shape: tuple[int, ...]) -> Doubles:
    array = np.asarray(_own(given[name], name))
    if array.shape != shape or array.dtype.kind not in "fiu":
        raise InputError(f"{name}: numbers of shape {shape} are wanted, not {array.dtype} of {array.shape}")
    return array.astype(np.float64)


def _by_matrices(given: dict[str, Any]) -> tuple[Doubles, Doubles, Doubles]:
    """The camera's axes in rows, where it is, and the inverse of its intrinsic matrix."""
    intrinsic = _numbers(given, "intrinsic_matrix", (3, 3))
    extrinsic = _numbers(given, "extrinsic_matrix", (4, 4))
    axes = extrinsic[:3, :3]
    try:
        inverse: Doubles = np.linalg.inv(intrinsic).astype(np.float64)
        return axes, -axes.T @ extrinsic[:3, 3], inverse
    except np.linalg.LinAlgError as why:
        raise InputError("intrinsic_matrix: it has no inverse") from why


def _by_view(given: dict[str, Any], width: int, height: int) -> tuple[Doubles, Doubles, Doubles]:
    center, eye, up = (_numbers(given, name, (3,)) for name in ("center", "eye", "up"))
    forward = center - eye
    right = np.cross(up, forward)
    if not (np.isfinite(right).all() and np.linalg.norm(right) > 0):
        raise UsageError("the camera looks nowhere, or straight along its own up")
    forward /= np.linalg.norm(forward)
    right /= np.linalg.norm(right)
    focal = 0.5 * width / math.tan(0.5 * math.radians(float(given["fov_deg"])))
    intrinsic = np.array([[focal, 0, 0.5 * width], [0, focal, 0.5 * height], [0, 0, 1]])
    return np.stack([right, np.cross(forward, right), forward]), eye, np.linalg.inv(intrinsic)
