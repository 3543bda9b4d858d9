"""What rays hit, and what is nearest to points: arrays with names."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from ._arrays import RayArrays

Array = npt.NDArray[Any]


class _Columns:
    """Arrays by name, all over the same elements."""

    __slots__ = ()
    _names: ClassVar[tuple[str, ...]] = ()

    def __len__(self) -> int:
        for name in self._names:
            column = getattr(self, "_" + name)
            if column is not None:
                return len(column)
        return 0

    def __repr__(self) -> str:
        shown = [
            f"{name}: {c.dtype}{list(c.shape)}" for name in self._names if (c := getattr(self, "_" + name)) is not None
        ]
        return f"<kdray.{type(self).__name__} {', '.join(shown)}>"


def _column(name: str, what: str) -> Any:
    def read(self: Any) -> Array:
        column: Array | None = getattr(self, "_" + name)
        if column is None:
            raise AttributeError(f"{name} was not asked for: name it in fields=")
        return column

    return property(read, doc=what)


class Hits(_Columns):
    """Of each ray what it hits first. All arrays have the shape of the rays, without the coordinates."""

    __slots__ = (
        "_geometry",
        "_instance",
        "_normal",
        "_point",
        "_point_given",
        "_primitive",
        "_rays",
        "_t",
        "_u",
        "_v",
    )
    _names = ("t", "geometry", "primitive", "u", "v", "normal", "point", "instance")
    _t: Array | None
    _geometry: Array | None
    _point: Array | None

    t = _column("t", "float32 or float64, as the rays: multiples of the direction; infinity for a miss.")
    geometry = _column("geometry", "int32: the geometry's id; -1 for a miss.")
    primitive = _column("primitive", "int32: the number within the geometry, from 0; -1 for a miss.")
    instance = _column("instance", "int32: the number among the geometry's instances; -1 where it isn't of such.")
    u = _column("u", "The weight of a triangle's second corner; of cones, the share of the axis. Of the type of `v`.")
    v = _column("v", 'The weight of a triangle\'s third corner: float32, or as t where geometry is "double" or "auto".')
    normal = _column("normal", "(..., 3) of unit length, of the surface itself; 0 for a miss.")

    def __init__(self, columns: dict[str, Array], rays: RayArrays | None = None) -> None:
        for name in self._names:
            setattr(self, "_" + name, columns.get(name))
        self._point_given = self._point is not None
        self._rays = rays

    @property
    def point(self) -> Array:
        """(..., 3) origin + t*direction; infinite for a miss.

        Unless it is named in ``fields=``, it is computed when it is first read, from the rays as they are then.
        """
        if self._point is None and self._rays is not None and self._t is not None:
            self._point = self._rays.points_at(self._t)
        if self._point is None:
            raise AttributeError("point was not asked for: name it in fields=")
        return self._point

    def _now_of(self, rays: RayArrays) -> None:
        """Other rays' answers have been written into the arrays."""
        if not self._point_given:
            self._point = None
        self._rays = rays

    @property
    def hit(self) -> npt.NDArray[np.bool_]:
        """bool: whether the ray hit anything."""
        if self._t is not None:
            return np.asarray(self._t < np.inf)
        return np.asarray((self._geometry if self._geometry is not None else self.primitive) >= 0)

    @property
    def fields(self) -> tuple[str, ...]:
        """The names of the arrays that are there."""
        there = (name for name in self._names if getattr(self, "_" + name) is not None)
        return tuple(name for name in there if name != "point" or self._point_given)


class AllHits:
    """Every crossing of every ray: those of ray i are ``splits[i]`` to ``splits[i + 1]``, sorted by t.

    Rays are numbered in C order where they came in an array of more than one dimension.
    """

    __slots__ = ("geometry", "instance", "more", "primitive", "splits", "t", "u", "v")

    def __init__(
        self,
        splits: Array,
        t: Array,
        geometry: Array,
        primitive: Array,
        u: Array,
        v: Array,
        more: Array,
        instance: Array,
    ) -> None:
        self.splits = splits.view(np.int64)  #: int64, one more than rays
        self.t = t  #: float64
        self.geometry = geometry.view(np.int32)  #: int32, the geometry's id
        self.primitive = primitive.view(np.int32)  #: int32, the number within the geometry
        self.u = u  #: float32, as in `Hits`
        self.v = v  #: float32
        self.more = more.view(np.bool_)  #: bool for each ray: there are more than `max_hits`
        self.instance = instance.view(np.int32)  #: int32, the number among the geometry's instances, or -1

    def __len__(self) -> int:
        return len(self.t)

    @property
    def ray(self) -> npt.NDArray[np.int64]:
        """int64: of each hit the number of its ray."""
        return np.repeat(np.arange(len(self.splits) - 1), self.counts)

    @property
    def counts(self) -> npt.NDArray[np.int64]:
        """int64: of each ray how many hits it has here."""
        return np.diff(self.splits)

    def __repr__(self) -> str:
        return f"<kdray.AllHits {len(self)} hits of {len(self.splits) - 1} rays>"


class ClosestPoints(_Columns):
    """Of each point what lies nearest to it. All arrays have the shape of the points, without coordinates."""

    __slots__ = ("_distance", "_geometry", "_instance", "_point", "_primitive", "_u", "_v")
    _names = ("distance", "point", "geometry", "primitive", "u", "v", "instance")

    distance = _column("distance", "float32 or float64, as the points; infinity where nothing is in reach.")
    point = _column("point", "(..., 3): the nearest point of a surface.")
    geometry = _column("geometry", "int32: the geometry's id, or -1.")
    primitive = _column("primitive", "int32: the number within the geometry, or -1.")
    u = _column("u", "As in `Hits`.")
    v = _column("v", "As in `Hits`.")
    instance = _column("instance", "int32: as in `Hits`.")

    def __init__(self, columns: dict[str, Array]) -> None:
        for name in self._names:
            setattr(self, "_" + name, columns.get(name))
