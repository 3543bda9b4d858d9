"""`Scene`: shapes in, answers and pictures out."""

from __future__ import annotations

import copy
import math
import os
import threading
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _arrays, _core, _drivers, errors
from ._arrays import Array, ArrayLike, RayArrays
from ._calls import in_one_line, short, tell_in_one_line
from ._pixels import pixels_of
from ._results import FLOATS, Rows, as_rows, hit_columns, in_parts, known, result_of, type_of, width_of
from .hits import AllHits, ClosestPoints, Hits
from .looks import Camera, Color, Light, Material, Vector, linear
from .picture import Picture
from .progress import Progress, teller
from .view import View, page_of

_USUAL = ("t", "geometry", "primitive", "u", "v", "normal")
_USUAL_OF_INSTANCES = (*_USUAL, "instance")


@dataclass(frozen=True)
class Part:
    """Primitives of a geometry, or instances, that follow each other and to which its file gives one name."""

    name: str
    first: int
    count: int


@dataclass(frozen=True)
class MaterialInfo:
    """What `Scene.materials` tells of one material."""

    name: str  #: that the file gives it, or ""
    primitives: int  #: that have it; of what instances are of they don't count, if it is a file's


@dataclass(frozen=True)
class Geometry:
    """What `Scene.info` tells of one geometry."""

    id: int
    name: str
    mask: int
    primitives: int  #: of instances: of each of them
    enabled: bool
    prototype: bool = False  #: seen by its instances alone
    instances: int = 0
    #: Of its primitives, and of its instances, in ascending order: what an OBJ file's objects or groups, a glTF file's
    #: nodes, an STL file's solids are called.
    parts: tuple[Part, ...] = field(default=(), repr=False)
    instance_parts: tuple[Part, ...] = field(default=(), repr=False)


@dataclass
class _Added:
    """What a geometry was added by, to make it again."""

    kind: str  # "mesh", "instances", or shapes' plural
    arrays: tuple[Array | None, ...]
    material: int | None
    prototype: bool
    of: int | None = None  # instances: their prototype

    def copy(self) -> _Added:
        return replace(self)


class Scene:
    """Geometries by id, and what can be asked of them.

    ``Scene(device="auto")`` is empty; `kdray.load` reads a file. Add meshes, spheres, cones, discs, tori and
    capsules, in whatever units they are (float64 vertices keep what float32 would lose: the scene is moved to its own
    centre first), then ask. The first question after a change builds the tree; `commit` does so at a time of your
    choosing.

    Any number of threads may ask one scene at once; one thread at a time may change it. Questions let go of the GIL,
    and Ctrl-C ends them.

    Shapes: rays are two arrays of shape (..., 3) of float32 or float64, in any layout; results have the shape (...).
    Origins, directions, t_min, t_max and masks are broadcast against each other as NumPy does: (5, 1, 3) and (1, 4, 3)
    are rays of shape (5, 4), and what has a single row is the same for all. Masked arrays are an InputError where an
    element is masked. Hits lie where ``t_min < t < t_max``, numbers of the rays' own type, and t
    counts in multiples of the direction. (Of hits in the start point itself, t = 0, `count_hits` and `all_hits` know
    where t_min is 0.)

    With ``geometry="double"`` a scene answers for its vertices and shapes as they were given: all questions are
    decided as exact arithmetic does (of shapes to 2^-96 of their size, of what all but touches a torus to 2^-50), and t
    of float64 rays is the nearest float64 but for its last place. That takes up to a few times as long, and instances
    take the memory of copies. Pictures are of the vertices rounded to floats, as all is otherwise.

    A scene can be copied and pickled; it then holds its arrays, or the name of the file that it was read from.

    OpenCL does not outlive a fork: once a process has committed, asked or listed devices, what it forks off is
    answered with a NoDeviceError. Start such processes by ``multiprocessing.get_context("spawn")``.
    """

    def __init__(self, *, device: str | int = "auto", compute_units: int = 0, geometry: str = "float") -> None:
        """`device`: "auto", "cpu", "gpu", a number of `kdray.devices()` or a part of a name.

        `compute_units`: only so many of the device's cores; 0 is all. Raises NoDeviceError where there is no such
        device. (Where there is none at all, the first commit does.) `geometry`: what vertices are to questions,
        "float", "double", or "auto": double in a scene of meshes without instances whose vertices are no floats.
        """
        self._start(_core.Scene(), _device(device), compute_units, geometry)

    def _start(self, core: Any, device: str, compute_units: int, geometry: str) -> None:
        if geometry not in ("float", "double", "auto"):
            raise errors.UsageError(f'geometry is "float", "double" or "auto", not {geometry!r}')
        self._core = core
        self._device, self._compute_units, self._geometry = device, compute_units, geometry
        self._file: tuple[str, float | None, float | None, str, str, str] | None = None
        self._added: dict[int, _Added] = {}  # by id
        self._end = 1 if core.geometries() else 0  # the next id
        self._materials: list[Material] = []
        self._has_first_material = False
        self._has_instances = any(core.info(id)[5] > 0 for id in core.geometries())
        self._pictures: list[Array | str] = []  # bytes, or a file's path
        self._lights: list[Light] = []
        self._colors: dict[str, Color] = {}  # "background", "ambient"
        self._sky: tuple[Any, ...] | None = None  # "gradient" or "environment", and what it was set by
        self._changed, self._committed, self._binary_form, self._quality = True, False, False, "balanced"
        self._in_doubles = False
        self._lock = threading.RLock()

    # ---- What it is made of

    def add_mesh(
        self,
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uv: ArrayLike | None = None,
        mask: int = -1,
        name: str | None = None,
        material: int | None = None,
        prototype: bool = False,
    ) -> int:
        """Adds triangles and returns their geometry id; arrays are copied.

        `vertices` (n, 3), `triangles` (m, 3) indices into them, `normals` (n, 3) for smooth shading. `uv` (n, 2) says
        where in its material's pictures each vertex lies: (0, 0) is a picture's upper left corner, (1, 1) its lower
        right one, and beyond them it is repeated. A ray sees the geometry where its mask and this one have a bit in
        common. `material` is one of `add_material`. A `prototype` is seen by its instances alone (`add_instances`).
        Raises InputError that names the element: an index out of range, a NaN.
        """
        v, _ = _arrays.vectors(vertices, "vertices")
        n = None if normals is None else _arrays.vectors(normals, "normals")[0]
        coordinates = None if uv is None else _arrays.pairs(uv, "uv")
        arrays = (v, _arrays.triangles(triangles), n, coordinates)
        return self._add("mesh", arrays, name, mask, material, prototype)

    def add_spheres(
        self,
        centers: ArrayLike,
        radii: ArrayLike,
        *,
        mask: int = -1,
        name: str | None = None,
        material: int | None = None,
        prototype: bool = False,
    ) -> int:
        """Adds exact spheres: `centers` (n, 3), `radii` (n,) or one for all, above 0."""
        arrays = {"centers": centers, "radii": radii}
        return self._add_shapes("spheres", arrays, name, mask, material, prototype)

    def add_cones(
        self,
        p0: ArrayLike,
        r0: ArrayLike,
        p1: ArrayLike,
        r1: ArrayLike,
        *,
        mask: int = -1,
        name: str | None = None,
        material: int | None = None,
        prototype: bool = False,
    ) -> int:
        """Adds truncated cones without caps, from p0 (n, 3) with radius r0 to p1 with r1 (equal: cylinders)."""
        arrays = {"bases": p0, "base_radii": r0, "apexes": p1, "apex_radii": r1}
        return self._add_shapes("cones", arrays, name, mask, material, prototype)

    def add_discs(
        self,
        centers: ArrayLike,
        normals: ArrayLike,
        radii: ArrayLike,
        *,
        mask: int = -1,
        name: str | None = None,
        material: int | None = None,
        prototype: bool = False,
    ) -> int:
        """Adds flat discs: `centers` (n, 3), `normals` (n, 3) of any length, `radii` (n,) or one for all."""
        arrays = {"centers": centers, "normals": normals, "radii": radii}
        return self._add_shapes("discs", arrays, name, mask, material, prototype)

    def add_tori(
        self,
        centers: ArrayLike,
        axes: ArrayLike,
        major_radii: ArrayLike,
        minor_radii: ArrayLike,
        *,
        mask: int = -1,
        name: str | None = None,
        material: int | None = None,
        prototype: bool = False,
    ) -> int:
        """Adds exact ring tori: `centers` (n, 3), `axes` (n, 3) of any length, both radii (n,) or one for all.

        A torus is what lies `minor_radii` off a circle of `major_radii` about its centre, across its axis, with
        0 < minor < major <= 4096 minor.
        """
        arrays = {"centers": centers, "axes": axes, "major_radii": major_radii, "minor_radii": minor_radii}
        return self._add_shapes("tori", arrays, name, mask, material, prototype)

    def add_shapes(
        self,
        kind: str,
        *,
        mask: int = -1,
        name: str | None = None,
        material: int | None = None,
        prototype: bool = False,
        **arrays: ArrayLike,
    ) -> int:
        """Adds shapes of any kind: ``add_shapes("spheres", centers=..., radii=...)`` is what `add_spheres` does.

        `kind` is a kind's plural, and each of its fields an array of that name: vectors (n, 3), numbers (n,) or one
        for all. There are spheres (centers, radii), cones (bases, base_radii, apexes, apex_radii), discs (centers,
        normals, radii), tori (centers, axes, major_radii, minor_radii) and capsules (starts, ends, radii). Raises
        UsageError that names what there is.
        """
        return self._add_shapes(kind, arrays, name, mask, material, prototype)

    def _add_shapes(
        self,
        kind: str,
        arrays: dict[str, ArrayLike],
        name: str | None,
        mask: int,
        material: int | None,
        prototype: bool,
    ) -> int:
        fields = _core.shape_fields(kind)
        rest = dict(arrays)
        rows: list[Array | None] = []
        for column, is_vector, may_be_left_out in fields:
            if column in rest:
                rows.append((_points if is_vector else _scalars)(rest.pop(column), column))
            elif may_be_left_out:
                rows.append(None)
            else:
                raise errors.UsageError(f"{kind} need {column}=")
        if rest:
            known = ", ".join(column for column, _, _ in fields)
            raise errors.UsageError(f"{kind} have no {next(iter(rest))}, but {known}")
        return self._add(kind, tuple(rows), name, mask, material, prototype)

    def _add(
        self,
        kind: str,
        arrays: tuple[Array | None, ...],
        name: str | None,
        mask: int,
        material: int | None,
        prototype: bool,
    ) -> int:
        with self._lock:
            bits = _arrays.mask_bits(mask)
            how = (name or "", bits, material or 0, prototype)
            made = self._core.add_mesh(*arrays, *how) if kind == "mesh" else self._core.add_shapes(kind, arrays, *how)
            geometry = int(made)
            kept = tuple(None if a is None else a.copy() for a in arrays)
            self._added[geometry] = _Added(kind, kept, material, prototype)
            self._end = geometry + 1
            self._changed = True
            return geometry

    def add_instances(
        self,
        prototype: int,
        transforms: ArrayLike,
        *,
        materials: ArrayLike | None = None,
        mask: int = -1,
        name: str | None = None,
    ) -> int:
        """Adds instances of a geometry that was added with `prototype=True`, and returns the id of all of them.

        `transforms`: (n, 3, 4), or (n, 4, 4) with last rows of 0 0 0 1, or one such matrix: they take points of the
        prototype to the scene, and may mirror and stretch (one direction up to 48 times as much as another).
        `materials`: one of `add_material` for each, or one for all, in place of the prototype's; -1 leaves an
        instance the prototype's. A million of them take about a second to commit, and less than a kilobyte each.
        Raises InputError that names the transform: a NaN, one that flattens.
        """
        rows = _arrays.transforms(transforms)
        of_each = None if materials is None else _arrays.masks(materials, "materials")[0]
        with self._lock:
            bits = _arrays.mask_bits(mask)
            geometry = int(self._core.add_instances(prototype, rows, of_each, name or "", bits))
            kept = (rows.copy(), None if of_each is None else of_each.copy())
            self._added[geometry] = _Added("instances", kept, None, False, prototype)
            self._end = geometry + 1
            self._has_instances = True
            self._changed = True
            return geometry

    def update_transforms(self, id: int, transforms: ArrayLike) -> None:
        """Other places for instances, as many as there are; the next commit builds the tree over them alone."""
        rows = _arrays.transforms(transforms)
        with self._lock:
            self._core.update_transforms(id, rows)
            added = self._added[id]
            added.arrays = (rows.copy(), *added.arrays[1:])
            self._changed = True

    def update_vertices(self, id: int, vertices: ArrayLike, normals: ArrayLike | None = None) -> None:
        """New places for a mesh's vertices, as many as it has, and normals where it has them; ids and numbers stay."""
        v, _ = _arrays.vectors(vertices, "vertices")
        n = None if normals is None else _arrays.vectors(normals, "normals")[0]
        with self._lock:
            self._core.update_vertices(id, v, n)
            added = self._added[id]
            added.arrays = (v.copy(), added.arrays[1], None if n is None else n.copy(), added.arrays[3])
            self._changed = True

    def remove(self, id: int) -> None:
        """Takes a geometry out; its id is not given again."""
        with self._lock:
            self._core.remove(id)
            self._added.pop(id, None)
            self._changed = True

    def enable(self, id: int, enabled: bool = True) -> None:
        """Shows a geometry again, or hides it (`enabled=False`), without losing it."""
        with self._lock:
            self._core.enable(id, bool(enabled))
            self._changed = True

    def set_mask(self, id: int, mask: int) -> None:
        """Another mask for a geometry."""
        with self._lock:
            self._core.set_mask(id, _arrays.mask_bits(mask))
            self._changed = True

    @property
    def geometries(self) -> list[Geometry]:
        """All geometries, by id."""
        return [self.info(id) for id in self._core.geometries()]

    def info(self, id: int) -> Geometry:
        """Name, mask and number of primitives of a geometry, and the names of its parts."""
        parts = (tuple(Part(*p) for p in of(id)) for of in (self._core.parts, self._core.instance_parts))
        return Geometry(id, *self._core.info(id), *parts)

    def mesh(self, id: int = 0) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
        """The triangles of a geometry where they are now: vertices (n, 3), as given, and their numbers (m, 3).

        Triangles are in the order of their numbers: where there are no shapes, row i is primitive i. Of a file
        (geometry 0) without what it keeps as instances. With it a file's mesh can be a prototype, or in another scene:
        ``scene.add_mesh(*kdray.load("a.stl").mesh(), prototype=True)``.
        """
        vertices, triangles = self._core.mesh(id)
        return vertices, triangles.astype(np.int64)

    @property
    def materials(self) -> list[MaterialInfo]:
        """The materials that hits may have (`materials_of`): the file's, then those that were added."""
        return [MaterialInfo(*m) for m in self._core.materials()]

    def names_of(self, hits: Hits | AllHits) -> npt.NDArray[np.object_]:
        """Of each hit the name of its part or, where that has none, of its geometry; "" for a miss."""
        geometries = self.geometries
        by_id = np.full(self._end + 1, "", dtype=object)  # the last one is of -1
        for g in geometries:
            by_id[g.id] = g.name
        names = np.array(by_id[hits.geometry], dtype=object)
        lies_in_one = np.asarray(hits.instance >= 0 if self._has_instances else np.zeros(names.shape, bool))
        for g in (g for g in geometries if g.parts or g.instance_parts):
            here = hits.geometry == g.id
            _put_names(names, here & ~lies_in_one, hits.primitive, g.parts)
            if g.instance_parts:
                _put_names(names, here & lies_in_one, hits.instance, g.instance_parts)
        return names

    def materials_of(self, hits: Hits | AllHits) -> npt.NDArray[np.int32]:
        """int32: of each hit the place of its material in `materials`; -1 for a miss."""
        columns = (hits.geometry, hits.primitive, hits.instance if self._has_instances else None)
        rows = (None if c is None else np.ascontiguousarray(c).reshape(-1).view(np.uint32) for c in columns)
        out = np.empty(hits.geometry.shape, np.int32)
        self._core.materials_of(*rows, out.reshape(-1).view(np.uint32))
        return out

    @property
    def primitives(self) -> int:
        """How many triangles and shapes are enabled, without those of instances."""
        return int(self._core.primitives())

    @property
    def bounds(self) -> npt.NDArray[np.float64] | None:
        """The least and the greatest coordinates, (2, 3); None where there is nothing. Commits changes."""
        ends = self._ready().bounds()
        return None if ends is None else np.array(ends)

    def offset_origins(self, hits: Hits, directions: ArrayLike) -> Array:
        """Origins of rays that leave what was hit, for shadows, reflections and ambient occlusion.

        These are `hits.point`, moved along `hits.normal` to the side that `directions` (broadcast to the hits) go to,
        by what rounding may have moved them: some 2e-6 of the scene's size (with doubles of double geometry 1e-14), and
        roundings of the way that the ray has come. A ray that began at `hits.point` itself would meet its own surface
        as often as not.
        """
        point, normal, rays = hits.point, hits.normal, hits._rays
        bounds = self.bounds
        size = 0.0 if bounds is None else float(np.abs(bounds[1] - bounds[0]).max())
        in_floats = point.dtype == np.float32
        way = np.abs(point).max(axis=-1, keepdims=True, initial=0.0)
        if rays is not None:
            start = np.abs(rays.origins).max(axis=-1, initial=0.0)
            way = way + (start.reshape(*way.shape) if len(start) == rays.n else start)
        share = 2.0**-46 if self._in_doubles and not in_floats else 2.0**-19
        move = share * size + (2.0**-21 if in_floats else 2.0**-50) * way
        along = (np.asarray(directions, np.float64) * normal).sum(axis=-1, keepdims=True)
        move = np.copysign(np.where(np.isfinite(move), move, 0.0), along)  # a miss stays where it is
        return np.asarray(point + move * normal, point.dtype)

    @property
    def geometry(self) -> str:
        """What vertices are to questions: "float" or "double". Commits changes."""
        self._ready()
        return "double" if self._in_doubles else "float"

    @property
    def warnings(self) -> list[str]:
        """What the reader of its file left out or changed, and what the last commit found, a line each."""
        return list(self._core.warnings())

    # ---- How it looks

    def add_picture(self, picture: ArrayLike | str | os.PathLike[str]) -> int:
        """Adds a picture for materials and returns its number, for `Material(picture=)` and its like.

        `picture`: a PNG or JPEG file, or an array (h, w, 3) of bytes from the top row down (uint8, codes of sRGB as
        files have them; red, green, blue), (h, w, 4) with alpha as well, (h, w) or (h, w, 1) grey, (h, w, 2) grey with
        alpha; anything that NumPy makes such an array of, such as an image of Pillow's. It is copied. Raises
        InputError for other types and shapes, for sides of more than 16384, and for a file that can't be read.
        """
        with self._lock:
            if isinstance(picture, (str, os.PathLike)):
                kept: Array | str = os.path.abspath(os.fspath(picture))
                number = int(self._core.add_picture_file(kept))
            else:
                kept = pixels_of(picture).copy()
                number = int(self._core.add_picture(kept))
            self._pictures.append(kept)
            return number

    def add_material(self, material: Material) -> int:
        """Adds a material, for `add_mesh(..., material=)`."""
        with self._lock:
            if not self._has_first_material:  # number 0 is of what is added without one
                self._add_to_core(Material())
                self._has_first_material = True
            number = self._add_to_core(material)
            self._materials.append(material)
            self._changed = True
            return number

    def _add_to_core(self, m: Material) -> int:
        diffuse = linear(m.diffuse)
        ambient = linear(m.ambient) if m.ambient is not None else [0.1 * c for c in diffuse]
        return int(
            self._core.add_material(
                linear(m.emission),
                ambient,
                diffuse,
                linear(m.specular),
                linear(m.reflect),
                linear(m.transmit),
                m.shine,
                m.index,
                m.picture_numbers(),
                m.alpha,
                (m.metallic, m.roughness, m.occlusion),
            )
        )

    def add_light(self, light: Light) -> None:
        """Adds a light. (Without any, a picture gets two.)"""
        with self._lock:
            self._core.add_light(
                light.kind,
                light.position,
                light.direction,
                linear(light.color),
                light.attenuation,
                light.range,
                light.inner,
                light.outer,
                light.across,
                light.down,
                light.normal,
                light.radius,
            )
            self._lights.append(light)
            self._changed = True

    def set_background(self, color: Color) -> None:
        """The colour of rays that hit nothing, linear RGB or as CSS has it ("skyblue", "#87ceeb")."""
        with self._lock:
            numbers = linear(color)
            self._core.set_background(numbers)
            self._colors["background"] = numbers
            self._sky = None
            self._changed = True

    def set_gradient(self, heights: Sequence[float], colors: Sequence[Color], up: Vector = (0.0, 1.0, 0.0)) -> None:
        """Rays that hit nothing see colours by height, the sine of the angle above the horizon, from -1 to 1.

        Heights ascend; below the first and above the last their colours go on.
        """
        if len(heights) != len(colors):
            raise errors.UsageError(f"{len(heights)} heights for {len(colors)} colours")
        with self._lock:
            numbers = tuple(linear(color) for color in colors)
            self._core.set_gradient(heights, numbers, up)
            self._sky = ("gradient", tuple(heights), numbers, tuple(up))
            self._changed = True

    def set_environment(
        self, file: str | os.PathLike[str], up: Vector = (0.0, 1.0, 0.0), turn: float = 0.0, strength: float = 1.0
    ) -> None:
        """Rays that hit nothing see a picture all around, from an EXR, Radiance HDR, PNG or JPEG file.

        It is equirectangular: its top lies at `up`, its middle at -z, turned about `up` by `turn` degrees. What
        it shows is multiplied by `strength`.
        """
        name = os.path.abspath(os.fspath(file))
        with self._lock:
            self._core.set_environment(name, up, turn, strength)
            self._sky = ("environment", name, tuple(up), turn, strength)
            self._changed = True

    def set_ambient(self, color: Color) -> None:
        """The light that comes from everywhere, linear RGB."""
        with self._lock:
            numbers = linear(color)
            self._core.set_ambient(numbers)
            self._colors["ambient"] = numbers
            self._changed = True

    # ---- Committing

    def commit(self, quality: str = "balanced") -> Scene:
        """Builds the tree of what the scene is now: "fast", "balanced" or "best". Never changes a hit.

        Questions from other threads are answered from the state before until it returns.
        """
        with self._lock:
            before, self._quality = self._quality, quality
            try:
                self._commit()
            except BaseException:
                self._quality = before
                raise
        return self

    def _commit(self) -> None:
        _drivers.choose()
        self._changed = False  # by now: what is changed meanwhile is for the next one
        try:
            self._in_doubles = self._core.commit(
                self._quality, self._device, self._compute_units, self._binary_form, self._geometry
            )
        except BaseException:
            self._changed = True
            raise
        self._committed = True

    def _type_of_weights(self, of_questions: Any) -> Any:
        return np.float32 if self._geometry == "float" else of_questions

    def _ready(self) -> Any:
        if self._changed or not self._committed:
            _core.refuse_after_fork()  # before the lock, which may be held by a thread that a fork left behind
            with self._lock:
                if self._changed or not self._committed:
                    self._commit()
        return self._core

    # ---- Rays

    def closest_hit(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0,
        t_max: ArrayLike = math.inf,
        mask: ArrayLike | None = None,
        out: Hits | None = None,
        *,
        fields: Iterable[str] | None = None,
        strict: bool = False,
        progress: Progress = False,
    ) -> Hits:
        """What each ray hits first.

        A ray that is asked again with its t as t_min, which is exclusive, finds what comes after just that hit. Which
        surface comes first is decided in floats about the scene's centre; t of a float64 ray is that of this surface
        in double, and hits lie between t_min and t_max. (What remains: one within some 4e-6 of the scene's size ahead
        of where the ray begins may be passed by, and of two as near to each other the farther one be found;
        `all_hits` decides the former in double.) Results are float32 for float32 rays. `fields` names the arrays of
        `Hits` that are wanted (all but `point`, and `instance` only where the scene has instances, if you say
        nothing): fewer are faster; `out` is a Hits to write into. Rays that mean nothing (NaN, no direction) are
        misses, or with `strict` an InputError that names the first.
        """
        rays = RayArrays(origins, directions, t_min, t_max, mask)
        usual = _USUAL_OF_INSTANCES if self._has_instances else _USUAL
        columns = hit_columns(rays, out, usual if fields is None else tuple(fields), self._type_of_weights(rays.dtype))
        rows = {name: as_rows(column, width_of(name)) for name, column in columns.items()}
        core = self._ready()

        def ask(part: RayArrays, cut: Rows) -> None:
            core.closest(*part.given(), strict, *(cut.get(name) for name in Hits._names))

        in_parts(rays, rows, ask, progress, "closest_hit")
        if out is None:
            return Hits(columns, rays)
        out._now_of(rays)
        return out

    def any_hit(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0,
        t_max: ArrayLike = math.inf,
        mask: ArrayLike | None = None,
        out: npt.NDArray[np.bool_] | None = None,
        *,
        strict: bool = False,
        progress: Progress = False,
    ) -> npt.NDArray[np.bool_]:
        """Whether each ray hits anything between t_min and t_max; for shadows and lines of sight.

        That is decided in floats, unless the scene has geometry="double": a surface within some 4e-6 of the scene's
        size of either end may count or not, so a line of sight to a surface is to end a little before it.
        """
        rays = RayArrays(origins, directions, t_min, t_max, mask)
        return self._ask_each(self._ready().any, rays, np.bool_, out, strict, progress, "any_hit")

    def count_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0,
        t_max: ArrayLike = math.inf,
        mask: ArrayLike | None = None,
        out: npt.NDArray[np.uint32] | None = None,
        *,
        strict: bool = False,
        progress: Progress = False,
    ) -> npt.NDArray[np.uint32]:
        """How many surfaces each ray crosses (uint32), each once, through edges and vertices too.

        A ray from outside of a closed mesh to its outside has an even count, always. Whether a float64 ray begins or
        ends before or behind a surface is decided by its doubles, at t_min = 0 for triangles exactly (corners are
        floats about the scene's centre, unless the scene has geometry="double").
        """
        rays = RayArrays(origins, directions, t_min, t_max, mask)
        return self._ask_each(self._ready().count, rays, np.uint32, out, strict, progress, "count_hits")

    def all_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0,
        t_max: ArrayLike = math.inf,
        mask: ArrayLike | None = None,
        *,
        max_hits: int | None = None,
        strict: bool = False,
    ) -> AllHits:
        """Every crossing of every ray, sorted by t, or the first `max_hits` of each ray.

        What `count_hits` says of float64 rays holds here; their t is found in double. Hits that don't fit into memory
        are refused (OutOfMemoryError) with their number; Ctrl-C ends the call.
        """
        most = 0xFFFFFFFF if max_hits is None else max_hits
        if not 0 <= most <= 0xFFFFFFFF:
            raise errors.UsageError(f"max_hits: {max_hits} is out of range")
        rays = RayArrays(origins, directions, t_min, t_max, mask)
        return AllHits(*self._ready().all(*rays.given(), strict, most))

    def _ask_each(
        self, question: Any, rays: RayArrays, dtype: Any, out: Array | None, strict: bool, progress: Progress, what: str
    ) -> Array:
        """One number for each ray."""
        result = result_of(out, rays.shape, dtype, "out")
        rows = as_rows(result).view(np.uint8) if dtype is np.bool_ else as_rows(result)

        def ask(part: RayArrays, cut: Rows) -> None:
            question(*part.given(), strict, cut["out"])

        in_parts(rays, {"out": rows}, ask, progress, what)
        return result

    # ---- Points

    def closest_point(
        self,
        points: ArrayLike,
        radius: float = math.inf,
        *,
        fields: Iterable[str] | None = None,
        strict: bool = False,
    ) -> ClosestPoints:
        """Of each point (..., 3) the nearest point of any surface within `radius`.

        `fields` names the arrays of `ClosestPoints` that are wanted (`instance` only where the scene has instances, if
        you say nothing).
        """
        rows, shape = _arrays.vectors(points, "points")
        usual = ClosestPoints._names if self._has_instances else ClosestPoints._names[:-1]
        wanted = known(usual if fields is None else fields, ClosestPoints._names)
        columns: dict[str, Array] = {}
        for name in wanted:
            dtype = type_of(name, rows.dtype, self._type_of_weights(rows.dtype))
            columns[name] = np.empty((*shape, 3) if name == "point" else shape, dtype)
        cut = {name: as_rows(column, width_of(name)) for name, column in columns.items()}
        self._ready().closest_points(rows, radius, strict, *(cut.get(name) for name in ClosestPoints._names))
        return ClosestPoints(columns)

    def signed_distance(
        self,
        points: ArrayLike,
        radius: float = math.inf,
        out: npt.NDArray[Any] | None = None,
        *,
        strict: bool = False,
    ) -> npt.NDArray[Any]:
        """The distance to the nearest surface, negative inside of closed ones; of the points' type.

        The sign is that of `contains`. A point with NaN has the distance nan, an infinite one inf; inside, what has
        nothing within `radius` has -inf.
        """
        rows, shape = _arrays.vectors(points, "points")
        result = result_of(out, shape, *(FLOATS if out is not None else (rows.dtype.type,)), "out")
        self._ready().signed_distance(rows, radius, strict, as_rows(result))
        return result

    def contains(
        self, points: ArrayLike, out: npt.NDArray[np.bool_] | None = None, *, strict: bool = False
    ) -> npt.NDArray[np.bool_]:
        """Whether each point lies inside: of an odd number of closed surfaces.

        float64 points are decided by their doubles, without a vote: exactly against triangles, whose corners are
        floats about the scene's centre (in a scene of 200 km they lie up to 4 mm beside what was given), or with
        geometry="double" what was given. float32
        points are rounded to floats there, and may be wrong within 2^-18 of the scene's size of a surface. A point
        that is not finite lies outside.
        """
        rows, shape = _arrays.vectors(points, "points")
        result = result_of(out, shape, np.bool_, "out")
        self._ready().inside(rows, strict, as_rows(result).view(np.uint8))
        return result

    # ---- Pictures

    def render(
        self,
        camera: Camera | None = None,
        size: tuple[int, int] = (1024, 1024),
        samples: int | None = None,
        depth: int = 5,
        *,
        crop: tuple[int, int, int, int] | None = None,
        look: str = "studio",
        adaptive: bool | float = False,
        channels: Iterable[str] = (),
        min_weight: float | None = None,
        mode: str = "auto",
        precision: str = "float",
        progress: Progress = False,
    ) -> Picture:
        """A Whitted picture, `size` = (width, height), by `camera` or one that sees all of the scene.

        `crop` = (x, y, width, height): this part of the picture alone, from its top left, with the pixels that the
        whole one has there.
        `look`: where the scene has neither a camera nor lights of its own, "studio" shows it in soft light that
        follows the camera, on a floor before a backdrop; "plain" by two lights before the background.
        `samples` per pixel (1, or 8 in a studio), or `adaptive`: as many as each pixel needs (a float: the error in
        linear RGB that is aimed at). `depth`: 1 is the eye ray alone. `channels`: of "depth" (from
        the eye), "normal" (as shading has it, towards the viewer: normal.x, normal.y and normal.z of the picture's
        channels), "primitive", "instance", "cost", "samples", "queue".
        `min_weight`: rays that change a pixel by less are left out; 0 traces all.
        """
        named = [channels] if isinstance(channels, str) else list(channels)
        if min_weight is not None and not 0 <= min_weight <= 1:
            raise errors.UsageError(f"min_weight is from 0 to 1, not {min_weight}")
        if adaptive != 0 and not 1e-6 <= adaptive <= 1e6:
            raise errors.UsageError(f"adaptive is True, False or an error from 1e-6 to 1e6, not {adaptive}")
        if named or precision == "double":
            self._with_binary_form()
        width, height = _size(size)
        numbers = {"the width": width, "the height": height, "samples": samples, "depth": depth}
        for name, value in numbers.items():
            if value is not None and value < 1:
                raise errors.UsageError(f"{name} is at least 1, not {value}")
        w, h, rgb, planes, warnings = self._ready().render(
            _camera(camera),
            width,
            height,
            samples or 0,
            depth,
            -1.0 if min_weight is None else min_weight,
            0.0075 if adaptive is True else float(adaptive),
            mode,
            precision,
            named,
            teller(progress, "render"),
            look,
            crop,
        )
        return Picture(rgb.reshape(h, w, 3), _planes(planes, h, w), list(warnings))

    def view(
        self,
        camera: Camera | None = None,
        size: tuple[int, int] = (960, 600),
        *,
        look: str = "studio",
        port: int = 0,
    ) -> View:
        """A page to look around in the scene, as it is now: in a notebook a frame of `size`, elsewhere an address.

        `camera`: where it begins; without one, where all of the scene is seen. `look` is that of `render`. `port`: 0
        is 7878, or the next one that is free. The page is served to this machine alone, until `View.close` or the end
        of the program; `View.update` shows what has been changed since.
        """
        width, height = _size(size)
        if width < 1 or height < 1:
            raise errors.UsageError(f"the size is at least 1 x 1, not {width} x {height}")
        if not 0 <= port <= 65535:
            raise errors.UsageError(f"a port is 1 to 65535, or 0, not {port}")
        self._with_binary_form()
        name = os.path.basename(self._file[0]) if self._file else "scene"
        core = page_of(self._ready(), name, _camera(camera), self._device, self._compute_units, port, look)
        return View(self, core, (width, height))

    def _with_binary_form(self) -> None:
        """The channels of a picture, double precision and the cells of the tree are of it."""
        if not self._binary_form:
            with self._lock:
                self._binary_form = self._changed = True

    # ---- Copies

    def __getstate__(self) -> dict[str, Any]:
        with self._lock:
            infos = [self.info(id) for id in self._core.geometries()]
            names = ("_device", "_compute_units", "_geometry", "_quality", "_file")
            looks = ("_pictures", "_materials", "_lights", "_colors", "_sky")
            return {name: copy.copy(getattr(self, name)) for name in (*names, *looks)} | {
                "added": {id: added.copy() for id, added in self._added.items()},
                "infos": infos,
                "end": self._end,
            }

    def __setstate__(self, state: dict[str, Any]) -> None:
        file = state["_file"]
        core = _core.Scene.load(*file) if file else _core.Scene()
        self._start(core, state["_device"], state["_compute_units"], state["_geometry"])
        self._file, self._quality = file, state["_quality"]
        for picture in state["_pictures"]:
            self.add_picture(picture)
        for material in state["_materials"]:
            self.add_material(material)
        for light in state["_lights"]:
            self.add_light(light)
        for name, color in state["_colors"].items():
            getattr(self, "set_" + name)(color)
        if state["_sky"]:
            getattr(self, "set_" + state["_sky"][0])(*state["_sky"][1:])
        infos = {info.id: info for info in state["infos"]}
        if file and 0 not in infos:
            self._core.remove(0)
        end = state.get("end", max(infos, default=-1) + 1)  # none: pickled by an older kdray
        for id in range(1 if file else 0, end):
            self._add_again(state["added"].get(id), infos.get(id))
        self._end = end
        for id, info in infos.items():
            self._core.enable(id, info.enabled)
            self._core.set_mask(id, info.mask)

    def _add_again(self, added: _Added | None, info: Geometry | None) -> None:
        """A geometry by the id that it had; one that was removed leaves its id."""
        if added is None or info is None:
            nothing = np.empty((0, 3), np.float32)
            self._core.remove(self._core.add_shapes("spheres", [nothing, nothing[:, 0]], "", 0, 0, False))
        elif added.of is not None:
            transforms, materials = added.arrays
            self.add_instances(added.of, transforms, materials=materials, mask=info.mask, name=info.name)
        else:
            self._add(added.kind, added.arrays, info.name, info.mask, added.material, added.prototype)

    def __copy__(self) -> Scene:
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> Scene:
        return self.copy()

    def copy(self) -> Scene:
        """A scene of its own, with the same ids."""
        made = type(self).__new__(type(self))
        made.__setstate__(self.__getstate__())
        return made

    def __repr__(self) -> str:
        return f"<kdray.Scene of {len(self._core.geometries())} geometries, {self.primitives} primitives>"


@in_one_line("kdray.load")
def load(
    path: str | os.PathLike[str],
    *,
    smooth: float | None = None,
    time: float | None = None,
    animation: str | int = "",
    asset_root: str | os.PathLike[str] = "",
    instances: str = "auto",
    device: str | int = "auto",
    geometry: str = "float",
) -> Scene:
    """A scene from a file: .obj, .ply, .stl, .gltf, .glb, .nff, kdray's .json, also .gz and .xz of these.

    What is in it is geometry 0. `smooth`: triangles without normals get some where the surface turns by no more
    than so many degrees. `time`: the second of a glTF file's animation that is seen, of the first or of the
    `animation` with this name or number, or "all"; without it nodes are at rest. `asset_root`: a folder below which
    the file may name pictures and buffers that are not beside it or below it. `instances`: meshes that the file shows
    many times are held once where copies would be over a million primitives ("auto"), always ("kept") or never
    ("flat"). `device` and `geometry` are `Scene`'s.
    Raises InputError with file, line, what is wrong and what to do.
    """
    chosen = _device(device)
    scene = Scene.__new__(Scene)
    root = os.fsdecode(asset_root)
    file = (os.path.abspath(os.fsdecode(path)), smooth, time, str(animation), root and os.path.abspath(root), instances)
    scene._start(_core.Scene.load(*file), chosen, 0, geometry)
    scene._file = file
    return scene


def set_texture_cache(size: int) -> None:
    """The most memory, in bytes, that this process takes for the texels of pictures that come from now on.

    What is more lies in files without names, in ``$TMPDIR`` or else ``/var/tmp``, of which the system holds in memory
    what is looked at: pictures are the same. By default it is half of the memory that is free.
    """
    if size < 0:
        raise errors.UsageError(f"a texture cache of {size} bytes; it may have 0 or more")
    _core.set_texture_cache(size)


# Those left out are called the most, and take arrays, which are looked at before.
tell_in_one_line(Scene, but={"closest_hit", "any_hit", "count_hits"})

# ---- Small things


def _size(size: Any) -> tuple[int, int]:
    try:
        width, height = size
    except (TypeError, ValueError):
        raise errors.UsageError(f"size is (width, height), not {short(size)}") from None
    return width, height


def _camera(camera: Any) -> list[float] | None:
    if camera is not None and not isinstance(camera, Camera):
        raise errors.UsageError(f"camera is a kdray.Camera, not {short(camera)}")
    return None if camera is None else camera.numbers()


def _device(wanted: str | int) -> str:
    """As kdray._core takes it. Raises NoDeviceError at once where there is no device of that name, number or kind."""
    name = str(wanted)
    if name.lower() not in ("auto", "", "cpu"):  # those take what is there, and OpenCL is not begun with for them
        _drivers.choose()
        _core.require_device(name)
    return name


def _points(values: ArrayLike, name: str) -> Array:
    return _arrays.vectors(values, name)[0]


def _scalars(values: ArrayLike, name: str) -> Array:
    return _arrays.scalars(values, name)[0]


def _put_names(names: Array, where: Array, numbers: Array, parts: tuple[Part, ...]) -> None:
    if not parts:
        return
    first = np.array([part.first for part in parts])
    behind = np.array([part.first + part.count for part in parts])
    named = np.array([part.name for part in parts], dtype=object)
    at = np.asarray(np.searchsorted(first, numbers, side="right") - 1)
    where = np.asarray(where & (at >= 0) & (numbers < behind[at]))
    names[where] = named[at[where]]


def _planes(planes: dict[str, Array], height: int, width: int) -> dict[str, npt.NDArray[np.float32]]:
    return {name: values.reshape(height, width) for name, values in planes.items()}
