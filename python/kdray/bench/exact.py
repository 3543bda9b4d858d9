"""The right answers about a mesh, by integers and fractions: floats are multiples of a power of two."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np

from .workload import Array

GROUP = 16  # triangles that are left out at once: neighbours in the list are mostly neighbours in space


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


def _balls(corners: Array) -> tuple[Array, Array]:
    """Middles and radii of balls about groups of points."""
    middles = (corners.min(axis=1) + corners.max(axis=1)) / 2
    return middles, np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)


def _meets(middles: Array, radii: Array, origin: Array, direction: Array) -> Array:
    """Whether the ray's line may meet each ball: in floats, with far more than they are off by."""
    to = middles - np.asarray(origin, np.float64)
    along = np.asarray(direction, np.float64) / np.abs(direction).max()
    away = np.linalg.norm(to - (to @ along / (along @ along))[:, None] * along, axis=1)
    found: Array = away <= radii + 1e-9 * (radii + np.linalg.norm(to, axis=1))
    return found


class Exact:
    """A mesh that is asked exactly: slow, and right whatever its size and wherever a ray passes."""

    def __init__(self, vertices: Array, triangles: Array) -> None:
        self.corners: Array = np.asarray(vertices, np.float64)[np.asarray(triangles)]
        self.balls = _balls(self.corners)
        groups = np.arange(-(-len(self.corners) // GROUP) * GROUP).clip(max=len(self.corners) - 1)
        self.group_balls = _balls(self.corners[groups].reshape(-1, 3 * GROUP, 3))

    def _near(self, origin: Array, direction: Array) -> Array:
        """The triangles that the ray's line may meet, and some more."""
        groups = np.flatnonzero(_meets(*self.group_balls, origin, direction))
        those = (groups[:, None] * GROUP + np.arange(GROUP)).ravel()
        those = those[those < len(self.corners)]
        found: Array = those[_meets(self.balls[0][those], self.balls[1][those], origin, direction)]
        return found

    def _ask(self, origin: Array, direction: Array) -> tuple[float, Array, int, bool]:
        near = self._near(origin, direction)
        (corners, start), unit = _integers(self.corners[near], origin)
        (along,), unit_along = _integers(direction)
        corners = corners - start
        sides = _cross(corners, np.roll(corners, -1, axis=1))
        # Of each triangle: how its plane lies to the origin, and the ray to each edge.
        volume, turns = _dot(corners[:, 2], sides[:, 0]), _dot(sides, along)
        whole = turns.sum(axis=1)
        met = ((turns >= 0).all(axis=1) | (turns <= 0).all(axis=1)) & (volume * whole > 0)
        ts = [Fraction(v, w) for v, w in zip(volume[met], whole[met], strict=True)]
        first = min(ts, default=None)
        here = np.flatnonzero(met)[[t == first for t in ts]]
        touches = bool((turns == 0).all(axis=1).any()) or len(set((volume[here] > 0).tolist())) > 1
        # The ray is turned by less than any number, so that it meets no edge.
        for axis in range(3):
            turns = np.where(turns == 0, sides[..., axis], turns)
        signs, ahead = np.sign(turns).astype(int), np.sign(volume).astype(int)
        crossed = (signs == ahead[:, None]).all(axis=1) & (ahead != 0)
        t = math.inf if first is None else float(first * (unit / unit_along))
        return t, near[here], int(np.count_nonzero(crossed)), touches

    def ask(self, origins: Array, directions: Array) -> tuple[Array, list[Array], Array, Array]:
        """Of each ray: `first`, the triangles that it meets there, `crossings`, and whether it may touch alone.

        One that lies in a triangle's plane, or first meets an edge between a front and a back, meets the surface or
        passes it, as one likes.
        """
        answers = [self._ask(o, d) for o, d in zip(origins, directions, strict=True)]
        t, nearest, crossings, touches = zip(*answers, strict=True)
        return np.array(t), list(nearest), np.array(crossings), np.array(touches)

    def crossings(self, origins: Array, directions: Array) -> Array:
        """How many triangles each ray crosses, one at an edge or a vertex; none that it begins on."""
        return self.ask(origins, directions)[2]

    def first(self, origins: Array, directions: Array) -> Array:
        """The t of each ray's first hit, edges and vertices included, rounded once; inf where there is none."""
        return self.ask(origins, directions)[0]

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
