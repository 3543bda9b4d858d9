"""The right answers about a mesh, by integers and fractions: floats are multiples of a power of two."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np

from .workload import Array


def _integers(*arrays: Array) -> tuple[list[Array], Fraction]:
    """The arrays as Python's integers, and what one of them is worth."""
    parts = [np.frexp(np.asarray(a, np.float64)) for a in arrays]
    least = min([int(e[m != 0].min()) for m, e in parts if m.any()], default=0) - 53
    shifts = [np.maximum(e - 53 - least, 0).astype(object) for _, e in parts]
    whole = [
        np.ldexp(m, 53).astype(np.int64).astype(object) * 2**shift for (m, _), shift in zip(parts, shifts, strict=True)
    ]
    return whole, Fraction(2) ** least


def _cross(a: Array, b: Array) -> Array:
    x, y = (np.moveaxis(v, -1, 0) for v in (a, b))
    return np.stack([x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]], axis=-1)


def _dot(a: Array, b: Array) -> Array:
    result: Array = (a * b).sum(axis=-1)
    return result


class Exact:
    """A mesh that is asked exactly: slow, and right whatever its size and wherever a ray passes."""

    def __init__(self, vertices: Array, triangles: Array) -> None:
        self.corners: Array = np.asarray(vertices, np.float64)[np.asarray(triangles)]
        self.middles = self.corners.mean(axis=1)
        self.reach = np.linalg.norm(self.corners - self.middles[:, None], axis=2).max(axis=1)

    def _near(self, origin: Array, direction: Array) -> Array:
        """The triangles that the ray's line may meet, and some more: in floats, with far more than they are off by."""
        to = self.middles - np.asarray(origin, np.float64)
        along = np.asarray(direction, np.float64) / np.abs(direction).max()
        away = np.linalg.norm(to - (to @ along / (along @ along))[:, None] * along, axis=1)
        found: Array = away <= self.reach + 1e-9 * (self.reach + np.linalg.norm(to, axis=1))
        return found

    def _seen_from(self, origin: Array, direction: Array) -> tuple[Array, Array, Array, Fraction]:
        """Of each triangle near it: how its plane lies to the origin, and the ray to each edge; and the unit of t."""
        (corners, start), unit = _integers(self.corners[self._near(origin, direction)], origin)
        (along,), unit_along = _integers(direction)
        corners = corners - start
        sides = _cross(corners, np.roll(corners, -1, axis=1))
        return _dot(corners[:, 2], sides[:, 0]), sides, _dot(sides, along), unit / unit_along

    def _crossed(self, origin: Array, direction: Array) -> int:
        """The crossings of a ray that is turned by less than any number, so that it meets no edge."""
        volume, sides, turns, _ = self._seen_from(origin, direction)
        for axis in range(3):
            turns = np.where(turns == 0, sides[..., axis], turns)
        signs, ahead = np.sign(turns).astype(int), np.sign(volume).astype(int)
        return int(np.count_nonzero((signs == ahead[:, None]).all(axis=1) & (ahead != 0)))

    def crossings(self, origins: Array, directions: Array) -> Array:
        """How many triangles each ray crosses, one at an edge or a vertex; none that it begins on."""
        return np.array([self._crossed(o, d) for o, d in zip(origins, directions, strict=True)])

    def first(self, origins: Array, directions: Array) -> Array:
        """The t of each ray's first hit, edges and vertices included, rounded once; inf where there is none."""
        found = np.full(len(origins), np.inf)
        for i, (origin, direction) in enumerate(zip(origins, directions, strict=True)):
            volume, _, turns, unit = self._seen_from(origin, direction)
            whole = turns.sum(axis=1)
            met = ((turns >= 0).all(axis=1) | (turns <= 0).all(axis=1)) & (volume * whole > 0)
            if met.any():
                t = min(Fraction(v, w) for v, w in zip(volume[met], whole[met], strict=True))
                found[i] = float(t * unit)
        return found

    def inside(self, points: Array) -> Array:
        """Whether each point lies inside of a closed mesh."""
        return np.asarray(self.crossings(points, np.broadcast_to([0.0, 0, 1], np.shape(points))) % 2 == 1)

    def signed_distance(self, points: Array) -> Array:
        """The distance to the nearest triangle, negative inside, from an exact square."""
        (corners, places), unit = _integers(self.corners, points)
        found = np.array([math.sqrt(min(map(_square, corners - p)) * unit**2) for p in places])
        return np.where(self.inside(points), -found, found)


def _square(corners: Array) -> Fraction:
    """The squared distance of the origin from a triangle."""
    normal = _cross(corners[1] - corners[0], corners[2] - corners[0])
    ahead = np.roll(corners, -1, axis=0)
    if (_dot(_cross(corners, ahead), normal) > 0).all():  # the foot of the plumb line lies inside
        return Fraction(int(_dot(corners[0], normal)) ** 2, int(_dot(normal, normal)))
    nearest: list[Fraction] = []
    for a, edge in zip(corners, ahead - corners, strict=True):
        along, length = int(-_dot(a, edge)), int(_dot(edge, edge))
        share = Fraction(min(max(along, 0), length), length)
        nearest.append(sum(((int(x) + share * int(e)) ** 2 for x, e in zip(a, edge, strict=True)), Fraction(0)))
    return min(nearest)
