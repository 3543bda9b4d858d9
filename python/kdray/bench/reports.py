"""Faults that others' users have reported, each as a small input of our own with the right answers.

A case is a function: what goes wrong is its docstring, where it was reported its decorator. Its mesh and what it asks
come from integers and seeds, its answers from a closed form or from `exact`; none is taken from a report. All but the
float64 cases are of floats, so that who computes in float32 is given the same numbers.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from .exact import Exact
from .meshes import ball, cube, doubles, floats, lattice, nested, octahedron, places_on, towards, unit
from .peers import Peer
from .workload import Array

SEED = 20261126


@dataclass(frozen=True)
class Case:
    """A mesh, a question about it (a method of `Peer`), its arrays, and what is right.

    `tolerance` is of t and of distances, in parts of them and of the mesh's size, whichever is more.
    """

    vertices: Array
    triangles: Array
    question: str
    asked: tuple[Array, ...]
    right: Array
    tolerance: float = 1e-5

    def wrong(self, answers: Array) -> int:
        """How many of the answers are."""
        if self.question in ("occlusion", "inside", "count"):
            return int(np.count_nonzero(np.asarray(answers) != self.right))
        size = float(np.linalg.norm(np.ptp(self.vertices, axis=0)))
        met = np.isfinite(self.right)
        allowed = self.tolerance * np.maximum(size, np.abs(np.where(met, self.right, 0)))
        with np.errstate(invalid="ignore"):
            near = np.abs(doubles(answers) - self.right) <= allowed
        return int(np.count_nonzero(~np.where(met, near, doubles(answers) == self.right)))

    def ask(self, peer: type[Peer]) -> int | None:
        """How many answers of a peer are wrong; None where it knows no such question."""
        question = getattr(peer, self.question, None)
        return None if question is None else self.wrong(question(peer(self.vertices, self.triangles), *self.asked))


@dataclass(frozen=True)
class Report:
    """A case's name, where its fault is reported, what goes wrong, and the case."""

    name: str
    where: tuple[str, ...]
    what: str
    make: Callable[[], Case]


REPORTS: list[Report] = []


def _reported(*where: str) -> Callable[[Callable[[], Case]], Callable[[], Case]]:
    def add(make: Callable[[], Case]) -> Callable[[], Case]:
        made = functools.cache(make)
        REPORTS.append(Report(make.__name__, where, (make.__doc__ or "").strip().rstrip("."), made))
        return made

    return add


@_reported("trimesh 242", "trimesh 545", "ncollpyde 3", "Open3D 5669")
def behind_corners() -> Case:
    """Points are inside or not by chance where the ray that is to tell passes through an edge or a corner."""
    vertices, triangles = octahedron(8)
    targets = places_on(vertices, triangles)
    random = np.random.default_rng(SEED)
    points = [lattice(*[np.arange(-8, 9)] * 3)]
    for direction in ([1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]):
        points.append(targets - random.uniform(0.5, 20, (len(targets), 1)) * unit(np.array(direction)))
    every = floats(np.concatenate(points))
    height = np.abs(doubles(every)).sum(axis=1)
    every, height = every[np.abs(height - 8) > 0.1], height[np.abs(height - 8) > 0.1]
    return Case(vertices, triangles, "inside", (every,), height < 8)


@_reported("trimesh 1180", "trimesh 263")
def from_within_all_hit() -> Case:
    """Of a panorama's rays from within a closed mesh, a few hit nothing."""
    vertices, triangles = ball(12)
    directions = unit(
        np.concatenate([places_on(vertices, triangles), np.random.default_rng(SEED).normal(size=(4000, 3))])
    )
    assert Exact(vertices, triangles).inside(np.zeros((1, 3))).all()
    origins = np.zeros_like(directions)
    return Case(vertices, triangles, "occlusion", (origins, directions), np.ones(len(origins), np.bool_))


@_reported("trimesh 1496")
def from_within_to_corners() -> Case:
    """Rays from a box's middle to corners of a larger one cross it once, and some no time or twice."""
    vertices, triangles = cube(6)
    origins, directions = np.zeros_like(vertices), vertices * floats(1.5)
    return Case(vertices, triangles, "count", (origins, directions), np.ones(len(vertices), np.int64))


@_reported("trimesh 1766")
def along_diagonals() -> Case:
    """A ray between a square's two triangles meets neither."""
    random = np.random.default_rng(SEED)
    n = 2000
    places = lattice(np.arange(50), np.arange(40), np.array([0])) * floats(2000)
    corners = places[:, None] + floats([[-7, -5, 0], [7, -5, 0], [7, 5, 0], [-7, 5, 0]])
    triangles = (4 * np.arange(n)[:, None, None] + np.array([[0, 1, 2], [2, 3, 0]])).reshape(-1, 3)
    ends = places + random.uniform(-0.9, 0.9, (n, 1)) * [7, 5, 0]
    origins = floats(ends + np.column_stack([random.uniform(-9, 9, (n, 2)), random.uniform(1, 99, n)]))
    rays, vertices = (origins, unit(ends - origins)), corners.reshape(-1, 3)
    return Case(vertices, triangles, "occlusion", rays, np.isfinite(Exact(vertices, triangles).first(*rays)))


@_reported("trimesh 2317", "FluidX3D 59", "libigl 2026")
def columns_through_corners() -> Case:
    """A ray through an edge or a corner counts as many crossings as triangles meet there, or none."""
    vertices, triangles = octahedron(8)
    places = lattice(np.arange(-9, 9.5, 0.5), np.arange(-9, 9.5, 0.5), np.array([-20]))
    reach = np.abs(places[:, :2]).sum(axis=1)
    places, reach = places[reach != 8], reach[reach != 8]
    return Case(vertices, triangles, "count", towards(places, (0, 0, 1)), np.where(reach < 8, 2, 0))


@_reported("trimesh 2504", "trimesh 48")
def thin_and_large() -> Case:
    """Where coordinates are large, the step beyond a hit is lost in rounding, or takes the next hit with it."""
    vertices, triangles = cube(1)
    vertices = vertices * floats([2**18, 2**18, 0.0625]) + doubles([2**20, 2**20, 2**20 + 0.0625])
    places = np.random.default_rng(SEED).integers(2**20 - 2**18 + 1, 2**20 + 2**18, (300, 3))
    places[:, 2] = 2**20 + 1000
    rays = towards(floats(places), (0, 0, -1))
    return Case(floats(vertices), triangles, "count", rays, np.full(300, 2))


@_reported("trimesh 2534")
def cavity() -> Case:
    """A cavity in a solid counts as inside."""
    points = lattice(*[np.arange(-7.5, 8, 1)] * 3) / floats(4)
    reach = np.abs(points).max(axis=1)
    return Case(*nested([1.75, 0.75], 3), "inside", (points,), (reach < 1.75) & (reach > 0.75))


@_reported("trimesh 1097")
def many_layers() -> Case:
    """Beyond twenty hits of a ray the others are left out."""
    places = lattice(np.arange(-60, 61, 8) / 64, np.arange(-60, 61, 8) / 64, np.array([-3.0])) + floats(2**-9)
    sizes = np.arange(1, 33) / floats(32)
    reach = np.abs(places[:, :2]).max(axis=1)
    return Case(*nested(list(sizes)), "count", towards(places, (0, 0, 1)), 2 * (reach[:, None] < sizes).sum(axis=1))


@_reported("Open3D 5105", "trimesh 73", "libigl 2348")
def diagonal_of_a_cube() -> Case:
    """The distance of a point outside of a cube, on its diagonal, is negative, 0 or a little off."""
    vertices, triangles = cube(1)
    points = lattice(*[np.array([-3, -2, -1, -0.5, 0, 0.5, 1, 2, 3])] * 3)
    points = points[np.abs(points).max(axis=1) != 1]
    beyond = np.abs(points) - 1
    right = np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0)
    return Case(vertices, triangles, "signed_distance", (points,), right)


@_reported("pyvista 8133", "pyvista 4240", "warp 922")
def ball_in_a_grid() -> Case:
    """Stripes of a grid about a ball are on the wrong side."""
    vertices, triangles = ball(8)
    points = lattice(*[np.arange(-1.25, 1.3, 0.125)] * 3)
    radius = np.linalg.norm(doubles(points), axis=1)
    least = np.linalg.norm(doubles(vertices)[triangles].mean(axis=1), axis=1).min() * 0.99
    points, radius = points[(radius < least) | (radius > 1.0001)], radius[(radius < least) | (radius > 1.0001)]
    return Case(vertices, triangles, "inside", (points,), radius < 1)


@_reported("Open3D 5777", "mitsuba2 171")
def plane_of_floats() -> Case:
    """The hits of float64 rays lie beside a plane whose corners are floats."""
    vertices = doubles([[-500, -500, 37.5], [500, -500, -12.25], [500, 500, 3.125], [-500, 500, 52.875]])
    return _onto_a_plane(vertices)


@_reported("Open3D 5777 (corners in double)")
def plane_of_doubles() -> Case:
    """The hits of float64 rays lie beside a plane whose corners are no floats."""
    vertices = doubles([[-500.1, -500.1, 37.3], [500.1, -500.1, -12.2], [500.1, 500.1, 3.1], [-500.1, 500.1, 52.6]])
    return _onto_a_plane(vertices)


def _onto_a_plane(vertices: Array) -> Case:
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    random = np.random.default_rng(SEED)
    ends = np.column_stack([random.uniform(-490, 490, (300, 2)), np.full(300, 20.0)])
    origins = np.column_stack([random.uniform(-490, 490, (300, 2)), random.uniform(300, 900, 300)])
    directions = (ends - origins) / np.linalg.norm(ends - origins, axis=1, keepdims=True)
    right = Exact(vertices, triangles).first(origins, directions)
    return Case(vertices, triangles, "closest", (origins, directions), right, tolerance=1e-13)


@_reported("Open3D 6188")
def around_a_cube() -> Case:
    """Of rays all around, some that pass a cube hit it, and others that meet its edges don't."""
    vertices, triangles = cube(1)
    turn = np.arange(720) * (np.pi / 360)
    flat = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(720)])
    ends = places_on(vertices, triangles) - [3, 0, 0]
    directions = unit(np.concatenate([flat, ends]) + 1e-4)
    rays = np.broadcast_to(floats([3, 0, 0]), directions.shape).copy(), directions
    return Case(vertices, triangles, "closest", rays, Exact(vertices, triangles).first(*rays))


@_reported("Embree 387", "Embree 423")
def along_slivers() -> Case:
    """A ray along a thin triangle far away hits it where it isn't."""
    random = np.random.default_rng(SEED)
    n = 600
    middles = doubles(lattice(np.arange(25), np.arange(24), np.array([0]))) * 4000
    along = doubles(unit(random.normal(size=(n, 3))))
    aside = np.cross(along, unit(random.normal(size=(n, 3))))
    corners = np.stack([middles, middles + 11 * along, middles + 9.6 * along + 0.3 * aside], axis=1)
    normal = doubles(unit(np.cross(along, aside)))
    ends = corners.mean(axis=1) + random.normal(size=(n, 1)) * 0.6 * aside
    start = ends - 500 * along + random.uniform(-4, 4, (n, 1)) * normal + random.uniform(-60, 60, (n, 1)) * aside
    vertices = floats(corners.reshape(-1, 3))
    rays = floats(start), unit(ends - start)
    triangles = np.arange(3 * n).reshape(n, 3)
    return Case(vertices, triangles, "closest", rays, Exact(vertices, triangles).first(*rays))


@_reported("Embree 174", "Embree 181")
def nested_prisms() -> Case:
    """A ray to a corner of the next prism passes it and hits one further out."""
    sides, vertices, triangles = 24, [], []
    turn = np.arange(sides) * (2 * np.pi / sides)
    i, j = np.arange(sides), np.roll(np.arange(sides), -1)
    for k, radius in enumerate(range(1, 9)):
        ring = np.column_stack([radius * np.cos(turn), radius * np.sin(turn)])
        vertices += [np.column_stack([ring, np.full(sides, z)]) for z in (-9.0, -1.0, 1.0, 9.0)]
        for row in range(3):
            a = (4 * k + row) * sides
            triangles += [
                np.column_stack([a + i, a + j, a + sides + j]),
                np.column_stack([a + i, a + sides + j, a + sides + i]),
            ]
    places, numbers = floats(np.concatenate(vertices)), np.concatenate(triangles)
    inner = places[sides : 3 * sides]
    directions = unit(
        np.concatenate([inner, (inner + np.roll(inner, 1, axis=0)) / 2, (inner[:sides] + inner[sides:]) / 2])
    )
    rays = np.zeros_like(directions), directions
    return Case(places, numbers, "closest", rays, Exact(places, numbers).first(*rays))


@_reported("Embree 416")
def beside_a_huge_square() -> Case:
    """A ray that begins just above a huge square, and leaves it, hits it."""
    vertices, triangles = floats([[-1, -1, -0.5], [1, -1, 0.5], [1, 1, 0.5], [-1, 1, -0.5]]), [[0, 1, 2], [0, 2, 3]]
    random = np.random.default_rng(SEED)
    beside = floats(random.integers(-(2**20), 2**20, (400, 3)) * 2)
    beside[:, 2] = beside[:, 0] / 2 + np.where(np.arange(400) % 2, 1, -1)
    rays = towards(beside, (0, 0, 1))
    return Case(vertices * floats(2**38), np.array(triangles), "occlusion", rays, np.arange(400) % 2 == 0)


@_reported("mitsuba3 1149", "trimesh 1919", "trimesh 1338")
def edges_from_outside() -> Case:
    """Rays to a ball's corners and edges pass it, or hit its far side."""
    mesh, rays = ball(4), _at_a_ball()
    return Case(*mesh, "closest", rays, Exact(*mesh).first(*rays))


@_reported("Embree 188", "trimesh 457")
def crossings_at_edges() -> Case:
    """Rays through a ball's corners and edges cross its near side twice, or no time."""
    mesh, rays = ball(4), _at_a_ball()
    return Case(*mesh, "count", rays, Exact(*mesh).crossings(*rays))


@functools.cache
def _at_a_ball() -> tuple[Array, Array]:
    """Rays from outside to the corners, edges and triangles of a ball, but for those that pass near its outline.

    There floats decide by their last bits, and no engine that takes floats is to be blamed for it.
    """
    mesh = Exact(*ball(4))
    targets = np.tile(places_on(*ball(4)), (2, 1))
    origins = floats(3 * unit(targets + 0.6 * np.random.default_rng(SEED).normal(size=targets.shape)))
    directions = unit(targets - origins)
    sure = np.ones(len(targets), np.bool_)
    for move in 1e-5 * np.array([[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]]):
        sure &= mesh.crossings(origins + move, directions) == mesh.crossings(origins, directions)
    return origins[sure], directions[sure]


@_reported("mitsuba3 61", "pyvista 918")
def from_far_away() -> Case:
    """Rays from far away pass small things, or hit what is beside them."""
    vertices, triangles = ball(4)
    away = unit(np.roll(places_on(vertices, triangles), 1, axis=1))
    rays = floats(2.0**17 * away + places_on(vertices, triangles) * 1.1), -away
    return Case(vertices, triangles, "occlusion", rays, np.isfinite(Exact(vertices, triangles).first(*rays)))


@_reported("libigl-python-bindings 78", "fcpw 14", "pyvista 4842")
def through_a_cube() -> Case:
    """Of a cube's two crossings one is lost, doubled or elsewhere."""
    vertices, triangles = cube(2)
    places = lattice(np.arange(-23, 24, 2) / 8, np.arange(-24, 25, 2) / 8, np.array([-10.0]))
    reach = np.abs(places[:, :2]).max(axis=1)
    places, reach = places[reach != 2], reach[reach != 2]
    return Case(vertices, triangles, "count", towards(places, (0, 0, 1)), np.where(reach < 2, 2, 0))


@_reported("warp 1836")
def sharp_tetrahedron() -> Case:
    """Points off a tetrahedron are inside by the normal of its nearest corner."""
    vertices = floats([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    triangles = np.array([[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]])
    points = floats(np.random.default_rng(SEED).uniform(-2.5, 3.5, (600, 3)))
    return Case(vertices, triangles, "signed_distance", (points,), Exact(vertices, triangles).signed_distance(points))


@_reported("tinybvh 283", "amrex 5789", "glm 1158")
def small_triangles() -> Case:
    """A tolerance that doesn't know the scene's size takes small triangles for none."""
    vertices, triangles = octahedron(4)
    scale = floats(2**-24)
    places = lattice(np.arange(-3.75, 4, 0.5), np.arange(-3.75, 4, 0.5), np.array([-5])) + floats([0, 0.125, 0])
    reach = np.abs(places[:, :2]).sum(axis=1)
    rays = towards(places * scale, (0, 0, 1))
    return Case(vertices * scale, triangles, "occlusion", rays, reach < 4)


@_reported("tinybvh 168", "FluidX3D 323")
def terrain() -> Case:
    """Rays straight down onto a terrain of integers fall through at its corners and edges."""
    n = 16
    height = np.random.default_rng(SEED).integers(0, 9, (n + 1, n + 1))
    vertices = lattice(np.arange(n + 1), np.arange(n + 1), np.array([0]))
    vertices[:, 2] = height.ravel()
    first = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = (v.ravel() for v in (first[:-1, :-1], first[1:, :-1], first[1:, 1:], first[:-1, 1:]))
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    rays = towards(lattice(np.arange(0.5, n, 0.5), np.arange(0.5, n, 0.5), np.array([100])), (0, 0, -1))
    return Case(vertices, triangles, "closest", rays, Exact(vertices, triangles).first(*rays))


def told(peers: Sequence[type[Peer]], reports: Sequence[Report] = REPORTS) -> list[str]:
    """A table, in Markdown: of each case how many answers are wrong, "-" where a peer isn't asked that."""
    heads = [f"{peer.name} {peer.version()}" for peer in peers]
    lines = ["| reported | asked | " + " | ".join(heads) + " |", "|---|---|" + "---|" * len(peers)]
    sums = [0] * len(peers)
    for report in reports:
        case, cells = report.make(), []
        for i, peer in enumerate(peers):
            try:
                wrong = case.ask(peer)
            except Exception as why:  # whatever it is, it's no answer
                cells.append(type(why).__name__)
                continue
            sums[i] += bool(wrong)
            cells.append("-" if wrong is None else str(wrong))
        asked = f"{len(case.right)} {case.question.replace('_', ' ')}"
        lines.append(f"| {', '.join(report.where)} | {asked} | " + " | ".join(cells) + " |")
    return [*lines, "| cases with wrong answers | | " + " | ".join(map(str, sums)) + " |"]
