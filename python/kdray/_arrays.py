"""Rows of whatever was given: the arrays that kdray._core reads in place.

A row's values lie side by side, in native byte order, as float32 or float64 (or integers, for
indices). What is like that already is not copied, whatever lies between two rows: nothing, other
values, or less than a row, as in what `np.broadcast_to` gives, where all rows are one.
"""

from __future__ import annotations

import math
import operator
from typing import Any

import numpy as np
import numpy.typing as npt

from . import errors

ArrayLike = Any  # npt.ArrayLike, or anything with __dlpack__
Array = npt.NDArray[Any]
Floats = npt.NDArray[Any]  # float32 or float64
Shape = tuple[int, ...]


def as_array(values: ArrayLike, name: str) -> Array:
    """`values` as a plain array of NumPy's, without a copy where it has memory of its own."""
    _refuse_masked(values, name)
    if hasattr(values, "__dlpack__") and not hasattr(values, "__array__"):
        try:
            return np.from_dlpack(values)
        except (BufferError, RuntimeError, TypeError, ValueError) as why:
            raise errors.InputError(f"{name}: can't be read through DLPack: {why}") from why
    try:
        return np.asarray(values)
    except (TypeError, ValueError) as why:
        raise errors.InputError(f"{name}: not an array: {why}") from why


def _refuse_masked(values: ArrayLike, name: str) -> None:
    """What is masked has a value all the same, which isn't meant."""
    parts = values if isinstance(values, (list, tuple)) else (values,)
    if any(isinstance(part, np.ma.MaskedArray) and np.ma.is_masked(part) for part in parts):
        raise errors.InputError(f"{name}: elements of it are masked; leave them out (compressed) or fill them (filled)")


def _floats(array: Array, name: str) -> Floats:
    if array.dtype.kind == "f":
        if array.dtype.itemsize in (4, 8) and array.dtype.isnative:
            return array
        return array.astype(np.float32 if array.dtype.itemsize < 8 else np.float64)
    if array.dtype.kind in "iub" and array.size:
        return array.astype(np.float64)
    if array.size == 0:
        return array.astype(np.float32)
    raise errors.InputError(f"{name}: numbers are wanted, not {array.dtype}")


def _side_by_side(rows: Array) -> Array:
    last = rows.ndim - 1
    good = rows.flags.aligned and rows.strides[0] >= 0 and rows.strides[0] % rows.itemsize == 0
    good = good and (last == 0 or rows.strides[last] == rows.itemsize)
    return rows if good else rows.copy()


def vectors(values: ArrayLike, name: str) -> tuple[Floats, Shape]:
    """N x 3 floats of an array of shape (..., 3), and that shape without the 3."""
    array = _floats(as_array(values, name), name)
    if array.ndim == 0 or array.shape[-1] != 3:
        if array.size == 0 and array.ndim == 1:
            return np.empty((0, 3), array.dtype), (0,)
        raise errors.InputError(f"{name}: the shape is to be (..., 3), not {array.shape}")
    return _side_by_side(array.reshape(-1, 3)), array.shape[:-1]


def scalars(values: ArrayLike, name: str) -> tuple[Floats, Shape]:
    """N floats of an array of any shape, and that shape."""
    array = _floats(as_array(values, name), name)
    return _side_by_side(array.reshape(-1)), array.shape


def pairs(values: ArrayLike, name: str) -> Floats:
    """N x 2 floats of an array of that shape."""
    array = _floats(as_array(values, name), name)
    if array.ndim != 2 or array.shape[1] != 2:
        raise errors.InputError(f"{name}: the shape is to be (n, 2), not {array.shape}")
    return _side_by_side(array)


def transforms(values: ArrayLike, name: str = "transforms") -> Floats:
    """N x 12 floats of an array of shape (n, 3, 4) or (n, 4, 4), or of one such matrix; not copied where it can be."""
    array = _floats(as_array(values, name), name)
    if array.ndim == 2 and array.shape in ((3, 4), (4, 4)):
        array = array[np.newaxis]
    if array.ndim == 2 and array.shape[1] == 12:
        return _side_by_side(array)
    if array.ndim != 3 or array.shape[1:] not in ((3, 4), (4, 4)):
        raise errors.InputError(f"{name}: the shape is to be (n, 3, 4) or (n, 4, 4), not {array.shape}")
    if array.shape[1] == 4:
        wrong = np.flatnonzero((array[:, 3] != (0, 0, 0, 1)).any(axis=-1))
        if wrong.size:
            raise errors.InputError(f"{name}[{wrong[0]}]: the last row is not 0 0 0 1")
        array = array[:, :3]
    return _side_by_side(array.reshape(-1, 12))


def triangles(values: ArrayLike, name: str = "triangles") -> Array:
    """N x 3 indices, signed or not, of 32 or 64 bits."""
    array = as_array(values, name)
    if array.size == 0:
        return np.empty((0, 3), np.uint32)
    if array.ndim != 2 or array.shape[1] != 3:
        raise errors.InputError(f"{name}: the shape is to be (n, 3), not {array.shape}")
    if array.dtype.kind not in "iu":
        raise errors.InputError(f"{name}: indices are whole numbers, not {array.dtype}")
    if array.dtype.itemsize not in (4, 8) or not array.dtype.isnative:
        array = array.astype(np.int64 if array.dtype.kind == "i" else np.uint64)
    return _side_by_side(array)


def masks(values: ArrayLike, name: str = "mask") -> tuple[Array, Shape]:
    """32 bits for each element, and the array's shape."""
    array = as_array(values, name)
    if array.dtype == np.uint32:
        return _side_by_side(array.reshape(-1)), array.shape
    if array.dtype.kind not in "iu" or (array.size and (array.min() < -(2**31) or array.max() >= 2**32)):
        raise errors.InputError(f"{name}: whole numbers of 32 bits are wanted")
    return array.reshape(-1).astype(np.int64).astype(np.uint32), array.shape


def mask_bits(mask: int) -> int:
    """A geometry's mask as a whole number of 32 bits; -1 is all of them."""
    try:
        whole = operator.index(mask)
    except TypeError:
        raise errors.InputError(f"mask: {mask!r} is no whole number") from None
    if not -(2**31) <= whole < 2**32:
        raise errors.InputError(f"mask: {whole} has more than 32 bits")
    return whole & 0xFFFFFFFF


def for_writing(array: Array, shape: Shape, types: tuple[type, ...], name: str) -> Array:
    """`array` as rows that results can be written to; it is the caller's own memory."""
    if not isinstance(array, np.ndarray):
        raise errors.InputError(f"{name}: results are written to arrays of NumPy's, not to {type(array).__name__}")
    if array.shape != shape or array.dtype.type not in types or not array.dtype.isnative:
        wanted = " or ".join(np.dtype(t).name for t in types)
        raise errors.InputError(
            f"{name}: the array is to be of shape {shape} and {wanted}, not {array.shape} and {array.dtype}"
        )
    if not array.flags.writeable or not array.flags.c_contiguous:
        raise errors.InputError(f"{name}: the array can't be written, or isn't in C order")
    return array


def _limit(value: ArrayLike, of_rays: Any) -> ArrayLike:
    """A t_min or t_max: a number of Python's is of the rays' type, as in NumPy's own arithmetic, where that holds it.

    (A single double among floats would have all rays traced as doubles.)
    """
    if type(value) not in (int, float) or of_rays != np.float32 or abs(value) > 1e300:
        return value
    with np.errstate(over="ignore", under="ignore"):
        single = np.float32(value)
    holds = bool(np.isfinite(single)) == math.isfinite(value) and (single == 0) == (value == 0)
    return single if holds else value


class RayArrays:
    """Rays as `kdray._core` takes them, and the shape of their results."""

    __slots__ = ("directions", "dtype", "masks", "n", "origins", "shape", "t_max", "t_min")

    def __init__(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike,
        t_max: ArrayLike,
        mask: ArrayLike | None,
    ) -> None:
        self.origins, o_shape = vectors(origins, "origins")
        self.directions, d_shape = vectors(directions, "directions")
        shapes = {"origins": o_shape, "directions": d_shape}
        self.dtype = max(self.origins.dtype, self.directions.dtype)  # float32 or float64
        self.t_min: Floats | None = None
        self.t_max: Floats | None = None
        self.masks: Array | None = None
        if not (isinstance(t_min, (int, float)) and t_min == 0):
            self.t_min, shapes["t_min"] = scalars(_limit(t_min, self.dtype), "t_min")
        if not (isinstance(t_max, float) and t_max == np.inf):
            self.t_max, shapes["t_max"] = scalars(_limit(t_max, self.dtype), "t_max")
        if mask is not None:
            self.masks, shapes["mask"] = masks(mask)
        wide = {shape for shape in shapes.values() if shape}
        self.shape = _common(shapes) if len(wide) > 1 else wide.pop() if wide else ()
        self.n = math.prod(self.shape)
        if wide:
            for name, shape in shapes.items():
                attribute = "masks" if name == "mask" else name
                setattr(self, attribute, _spread(getattr(self, attribute), shape, self.shape))
        if self.n == 0:  # an empty array can't stand for "the same for all"
            self.origins = self.directions = np.empty((0, 3), self.dtype)
            self.t_min = self.t_max = self.masks = None

    def given(self) -> tuple[Array | None, ...]:
        """The arguments that every query of rays begins with."""
        return self.origins, self.directions, self.t_min, self.t_max, self.masks

    def points_at(self, t: Array) -> Floats:
        """The points origin + t*direction of all rays, in double and then of the rays' own type."""
        rows = t.reshape(-1, 1).astype(np.float64)
        with np.errstate(invalid="ignore"):
            points = np.where(rows < np.inf, self.origins + rows * self.directions, np.inf)
        return points.astype(self.dtype).reshape(*self.shape, 3)

    def part(self, first: int, end: int) -> RayArrays:
        """The rays first to end."""
        part = object.__new__(RayArrays)
        part.dtype, part.n, part.shape = self.dtype, end - first, (end - first,)
        for name in ("origins", "directions", "t_min", "t_max", "masks"):
            rows = getattr(self, name)
            setattr(part, name, rows if rows is None or len(rows) == 1 else rows[first:end])
        return part


def _common(shapes: dict[str, Shape]) -> Shape:
    """The shape of all together, as NumPy broadcasts."""
    before: dict[str, Shape] = {}
    for name, shape in shapes.items():
        try:
            np.broadcast_shapes(*before.values(), shape)
        except ValueError:
            widest = max(before, key=lambda other: math.prod(before[other]))
            raise errors.InputError(f"{name} has shape {shape} where {widest} has {before[widest]}") from None
        before[name] = shape
    return np.broadcast_shapes(*before.values())


def _spread(rows: Array, shape: Shape, common: Shape) -> Array:
    """A row for each ray, of rows of another shape; one that is the same for all stays alone."""
    if len(rows) == 1 or shape == common:
        return rows
    wide = rows.shape[1:]
    return _side_by_side(np.broadcast_to(rows.reshape(*shape, *wide), (*common, *wide)).reshape(-1, *wide))
