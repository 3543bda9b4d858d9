"""Meshes whose corners and edges are known, and rays and points about them, for `reports`.

Meshes are closed, their triangles counterclockwise from outside, their coordinates float32.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from .workload import Array


def floats(values: ArrayLike) -> Array:
    """As float32."""
    return np.asarray(values, np.float32)


def doubles(values: ArrayLike) -> Array:
    """As float64."""
    return np.asarray(values, np.float64)


def cube(n: int) -> tuple[Array, Array]:
    """The cube from -n to n, n*n squares to a side; corners are integers."""
    places: list[Array] = []
    triangles: list[Array] = []
    for axis in range(3):
        for side in (-n, n):
            i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
            face = np.stack([np.full_like(i, side), 2 * i - n, 2 * j - n], axis=-1)
            first = sum(map(len, places)) + np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
            a, b, c, d = first[:-1, :-1], first[1:, :-1], first[1:, 1:], first[:-1, 1:]
            halves = np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
            places.append(np.roll(face, axis, axis=-1).reshape(-1, 3))
            triangles.append(halves if side > 0 else halves[:, ::-1])
    return _merged(np.concatenate(places), np.concatenate(triangles))


def octahedron(n: int) -> tuple[Array, Array]:
    """|x| + |y| + |z| = n, with a corner at each place of integers."""
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    upper = np.array([[i, i + 1, i], [j, j, j + 1]])[:, :, i + j < n]
    lower = np.array([[i + 1, i + 1, i], [j, j + 1, j + 1]])[:, :, i + j < n - 1]
    places: list[Array] = []
    triangles: list[Array] = []
    for octant in range(8):
        signs = 1 - 2 * np.array([octant & 1, octant >> 1 & 1, octant >> 2])
        for x, y in (upper.transpose(0, 2, 1), lower.transpose(0, 2, 1)):
            corners = np.stack([x, y, n - x - y], axis=-1) * signs
            corners = corners if np.prod(signs) > 0 else corners[:, ::-1]
            triangles.append(np.arange(corners.size // 3).reshape(-1, 3) + sum(map(len, places)))
            places.append(corners.reshape(-1, 3))
    return _merged(np.concatenate(places), np.concatenate(triangles))


def _merged(places: Array, triangles: Array) -> tuple[Array, Array]:
    vertices, numbers = np.unique(places, axis=0, return_inverse=True)
    return vertices.astype(np.float32), numbers.reshape(-1)[triangles].astype(np.int32)


def ball(n: int) -> tuple[Array, Array]:
    """The cube's corners, moved onto the unit sphere."""
    vertices, triangles = cube(n)
    return unit(np.tan(vertices / n * (np.pi / 4))), triangles


def unit(vectors: Array) -> Array:
    """Float vectors of a length of about 1."""
    v = doubles(vectors)
    return floats(v / np.linalg.norm(v, axis=-1, keepdims=True))


def nested(sizes: Sequence[float], n: int = 1) -> tuple[Array, Array]:
    """Cubes in one another, every other one turned inside out."""
    vertices, triangles = cube(n)
    parts = [triangles[:, :: 1 - 2 * (k % 2)] + k * len(vertices) for k in range(len(sizes))]
    return np.concatenate([vertices * (floats(s) / n) for s in sizes]), np.concatenate(parts)


def places_on(vertices: Array, triangles: Array) -> Array:
    """The corners, the middles of edges and of triangles."""
    corners = doubles(vertices)[triangles]
    middles = (corners + np.roll(corners, 1, axis=1)) / 2
    return np.concatenate([doubles(vertices), np.unique(middles.reshape(-1, 3), axis=0), corners.mean(axis=1)])


def lattice(*coordinates: Array) -> Array:
    """All points with these coordinates."""
    return np.stack(np.meshgrid(*coordinates, indexing="ij"), axis=-1).reshape(-1, len(coordinates)).astype(np.float32)


def towards(origins: Array, direction: Sequence[float]) -> tuple[Array, Array]:
    """Rays that begin there, all in one direction."""
    return origins, np.broadcast_to(floats(direction), origins.shape).copy()
