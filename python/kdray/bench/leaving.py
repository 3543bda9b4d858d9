"""Rays that begin on a mesh's surface, as a campaign asks them.

What begins at a vertex never hits a triangle that has it as a corner; forms of a question agree, and few rays get what
many get (the host answers few of doubles alone); and of doubles hits are those of exact arithmetic where meshes are
closed. (Counts and lists have what lies at 0 as well, which closest and any hits haven't.)
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np

from ..scene import Scene
from .exact import Exact
from .workload import Array, Mesh, Query

if TYPE_CHECKING:
    from .campaign import Unit

MANY, FEW = 2**14, 2**9  # rays of doubles that the device looks at first, and that the host answers alone
SAMPLE = 24  # rays that are held against exact arithmetic
LAST_PLACES = 2**-51  # that the t of doubles may be off


def leave(mesh: Mesh, n: int, seed: int) -> tuple[Query, Array]:
    """So many such rays, in the precision of the vertices, and the vertices that they begin at.

    They begin at vertices (elsewhere that is -1), on edges, within triangles and at their middle; they go along the
    normal, to either side; along an edge; over the triangle; to another vertex; and anywhere. Half of them are turned
    by 2^-5 to 2^-30.
    """
    random = np.random.default_rng(seed)
    vertices = mesh.vertices.astype(np.float64)
    which = mesh.triangles[random.integers(len(mesh.triangles), size=n)]
    which = which[np.arange(n)[:, None], (random.integers(3, size=n)[:, None] + np.arange(3)) % 3]
    a, b, c = np.moveaxis(vertices[which], 1, 0)
    weights = random.dirichlet((1, 1, 1), n)
    weights[::4] = 1, 0, 0
    weights[1::4, 2] = 0
    weights[1::4] /= weights[1::4].sum(axis=1, keepdims=True)
    weights[3::4] = 1 / 3
    starts = np.einsum("ij,ijk->ik", weights, vertices[which]).astype(mesh.vertices.dtype)
    first, second = ((x - a) / mesh.size for x in (b, c))
    normal = np.cross(first, second)
    other = (vertices[random.choice(mesh.triangles.ravel(), n)] - starts) / mesh.size
    ways = np.stack([normal, -normal, first, first + second, other, random.normal(size=a.shape)])
    directions = ways[np.arange(n) // 4 % len(ways), np.arange(n)]
    length = np.linalg.norm(directions, axis=1, keepdims=True)
    directions = np.where(length > 0, directions / np.where(length > 0, length, 1), (0, 0, 1))
    turned = random.integers(2, size=(n, 1)) * 2.0 ** -random.uniform(5, 30, (n, 1))
    directions += turned * random.normal(size=(n, 3))
    begins_at = np.where(np.arange(n) % 4 == 0, which[:, 0], -1)
    return Query(starts, directions.astype(mesh.vertices.dtype)), begins_at


def ask(scene: Scene, unit: Unit, dtype: type[np.floating[Any]], found: Counter[str]) -> tuple[int, int]:
    """Counts wrong answers by kind; returns how many rays there were, and how many exact arithmetic judged."""
    mesh, n = unit.mesh, max(len(unit.rays) // 4, MANY)
    assert mesh is not None
    query, begins_at = leave(mesh, n, unit.seed)
    given = query.of(dtype)
    assert given.directions is not None
    rays = given.origins, given.directions
    closest, any_hit = scene.closest_hit(*rays, fields=["t", "primitive"]), scene.any_hit(*rays)
    few = scene.closest_hit(rays[0][:FEW], rays[1][:FEW], fields=["t", "primitive"])
    count, splits = scene.count_hits(*rays), scene.all_hits(*rays).splits
    hit = closest.t < np.inf
    wrong = {
        "any": any_hit != hit,
        "all": np.diff(splits) != count,
        "few": (few.t != closest.t[:FEW]) | (few.primitive != closest.primitive[:FEW]),
    }
    if mesh.vertices.dtype == np.float32 or dtype == np.float64:  # else they begin beside the vertices
        corners = mesh.triangles[np.where(hit, closest.primitive, 0)]
        wrong["own"] = hit & (corners == begins_at[:, None]).any(axis=1)
    judged = 0
    if dtype == np.float64 and unit.closed:
        sample = np.random.default_rng(unit.seed).choice(n, SAMPLE)
        t, nearest, _, touches = Exact(mesh.vertices, mesh.triangles).ask(rays[0][sample], rays[1][sample])
        sure, here = ~touches, np.isfinite(t)
        judged = int(np.count_nonzero(sure))
        wrong["hit"] = sure & (hit[sample] != here)
        both = sure & hit[sample] & here
        wrong["t"] = np.abs(closest.t[sample][both] - t[both]) > LAST_PLACES * t[both]
        named = zip(closest.primitive[sample][both], np.flatnonzero(both), strict=True)
        wrong["other"] = np.array([triangle not in nearest[i] for triangle, i in named], bool)
    found.update({f"leaving, {np.dtype(dtype)}: {name}": int(np.count_nonzero(w)) for name, w in wrong.items()})
    return 4 * n + FEW, judged
