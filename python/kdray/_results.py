"""The arrays that answers are written to: made anew, or the caller's own."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from . import _arrays, errors
from ._arrays import Array, RayArrays
from .hits import Hits
from .progress import Progress, teller

Rows = dict[str, Array]  # results as kdray._core writes them
FLOATS = (np.float32, np.float64)
_WORDS = ("geometry", "primitive", "instance")
_AT_ONCE = 1 << 20  # rays between two words of progress


def known(fields: Iterable[str], names: tuple[str, ...]) -> list[str]:
    wanted = list(fields)
    for name in wanted:
        if name not in names:
            raise errors.UsageError(f"there is no field {name!r}; there are {', '.join(names)}")
    return wanted


def width_of(name: str) -> int:
    """How many values of a field there are for each ray or point."""
    return 3 if name in ("normal", "point") else 1


def type_of(name: str, of_rays: Any, of_weights: Any) -> Any:
    if name in _WORDS:
        return np.int32
    return of_weights if name in ("u", "v") else of_rays


def hit_columns(rays: RayArrays, out: Hits | None, fields: tuple[str, ...], of_weights: Any) -> dict[str, Array]:
    columns: dict[str, Array] = {}
    if out is None:
        for name in known(fields, Hits._names):
            shape = (*rays.shape, 3) if width_of(name) == 3 else rays.shape
            columns[name] = np.empty(shape, type_of(name, rays.dtype, of_weights))
        return columns
    if not isinstance(out, Hits):
        raise errors.InputError(f"out: a kdray.Hits is wanted, not {type(out).__name__}")
    for name in out.fields:
        shape = (*rays.shape, 3) if width_of(name) == 3 else rays.shape
        types = (np.int32,) if name in _WORDS else FLOATS
        columns[name] = _arrays.for_writing(getattr(out, name), shape, types, f"out.{name}")
    return columns


def as_rows(column: Array, values: int = 1) -> Array:
    """The memory of a result as rows of so many values, for `kdray._core`; a view, never a copy."""
    if column.dtype == np.int32:
        column = column.view(np.uint32)
    return column.reshape(-1) if values == 1 else column.reshape(-1, values)


def result_of(out: Array | None, shape: tuple[int, ...], *types_and_name: Any) -> Array:
    *types, name = types_and_name
    if out is None:
        return np.empty(shape, types[0])
    return _arrays.for_writing(out, shape, tuple(types), name)


def in_parts(
    rays: RayArrays, rows: Rows, ask: Callable[[RayArrays, Rows], None], progress: Progress, what: str
) -> None:
    """Asks for all rays at once, or so many at a time that there is something to tell."""
    tell = teller(progress, what)
    if tell is None or rays.n <= _AT_ONCE:
        ask(rays, rows)
        return
    for first in range(0, rays.n, _AT_ONCE):
        end = min(first + _AT_ONCE, rays.n)
        ask(rays.part(first, end), {name: column[first:end] for name, column in rows.items()})
        tell(end / rays.n)
