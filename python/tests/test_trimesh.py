"""kdray as trimesh's engine, held against trimesh's own."""

import copy
import pickle
import subprocess
import sys
import threading

import numpy as np
import pytest

import kdray

trimesh = pytest.importorskip("trimesh")

import kdray.trimesh as engine  # noqa: E402
from kdray.trimesh import RayMeshIntersector  # noqa: E402


@pytest.fixture
def installed():
    engine.install()
    yield
    engine.uninstall()


@pytest.fixture
def ball():
    return trimesh.creation.icosphere(subdivisions=3)


def its_own(mesh):
    """trimesh's engine in plain NumPy."""
    pytest.importorskip("rtree")
    return trimesh.ray.ray_triangle.RayMeshIntersector(mesh)


def some_rays(rng, n=300):
    """Rays of very different lengths, most of them towards the origin."""
    origins = 2 * rng.normal(size=(n, 3))
    return origins, (0.4 * rng.normal(size=(n, 3)) - origins) * rng.uniform(0.01, 100, (n, 1))


def by_place(result):
    places, rays, faces = result
    order = np.lexsort((*places.round(9).T, rays))
    return places[order], rays[order], faces[order]


@pytest.mark.parametrize("multiple_hits", [False, True])
def test_hits_are_its_own_engines(ball, rng, multiple_hits):
    rays = some_rays(rng)
    expected = its_own(ball).intersects_location(*rays, multiple_hits=multiple_hits)
    found = RayMeshIntersector(ball).intersects_location(*rays, multiple_hits=multiple_hits)
    assert len(found[0]) > 200
    for mine, theirs in zip(by_place(found), by_place(expected), strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=0, atol=1e-12)
    places, index_ray, index_tri = found
    assert (places.dtype, index_ray.dtype, index_tri.dtype) == (np.float64, np.int64, np.int64)
    assert (np.diff(index_ray) >= 0).all()
    distance = np.linalg.norm(places - rays[0][index_ray], axis=1)
    assert (np.diff(distance)[np.diff(index_ray) == 0] > 0).all()


def test_the_other_questions_are_answered_alike(ball, rng):
    rays = some_rays(rng)
    mine, theirs = RayMeshIntersector(ball), its_own(ball)
    first = mine.intersects_first(*rays)
    assert first.dtype == np.int64 and (first == -1).any()
    np.testing.assert_array_equal(first, theirs.intersects_first(*rays))
    any_hit = mine.intersects_any(*rays)
    assert any_hit.dtype == np.bool_
    np.testing.assert_array_equal(any_hit, first >= 0)
    index_tri, index_ray = mine.intersects_id(*rays, multiple_hits=False)
    np.testing.assert_array_equal(index_ray, np.flatnonzero(first >= 0))
    np.testing.assert_array_equal(index_tri, first[first >= 0])
    points = rng.uniform(-1, 1, (300, 3))
    inside = mine.contains_points(points)
    assert inside.dtype == np.bool_
    np.testing.assert_array_equal(inside, theirs.contains_points(points))


def test_at_most_so_many_hits(ball, rng):
    rays = some_rays(rng)
    mine = RayMeshIntersector(ball)
    nearest = mine.intersects_id(*rays, max_hits=1, return_locations=True)
    first = mine.intersects_id(*rays, multiple_hits=False, return_locations=True)
    for a, b in zip(nearest, first, strict=True):
        np.testing.assert_array_equal(a, b)


def test_places_lie_on_the_meshs_own_triangles(ball, rng):
    """To double's precision, not on what float makes of them, and far from the origin as well."""
    ball.apply_translation([528980.85, 183526.1, 0.1])
    origins = ball.centroid + 5 * rng.normal(size=(500, 3))
    places, _, faces = RayMeshIntersector(ball).intersects_location(origins, ball.centroid - origins)
    assert len(places) > 900
    a, b, c = np.moveaxis(ball.triangles[faces], 1, 0)
    normals = np.cross(b - a, c - a)
    off = np.einsum("ij,ij->i", places - a, normals) / np.linalg.norm(normals, axis=1)
    assert np.abs(off).max() < 1e-9


def test_rays_along_edges_and_through_vertices_cross_once():
    box = trimesh.creation.box().subdivide().subdivide()
    mine = RayMeshIntersector(box)
    origins = np.zeros_like(box.vertices)
    _, index_ray = mine.intersects_id(origins, box.vertices)
    np.testing.assert_array_equal(index_ray, np.arange(len(box.vertices)))
    grid = np.linspace(-0.5, 0.5, 9)[1:-1]
    x, y = (axis.ravel() for axis in np.meshgrid(grid, grid))
    origins = np.stack([x, y, np.full_like(x, -3)], axis=1)
    places, index_ray, _ = mine.intersects_location(origins, np.tile([0, 0, 1], (len(x), 1)))
    np.testing.assert_array_equal(index_ray, np.repeat(np.arange(len(x)), 2))
    np.testing.assert_array_equal(places[:, 2], np.tile([-0.5, 0.5], len(x)))


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e8])
@pytest.mark.parametrize("away", [0.5, 1e7])
def test_a_box_has_two_sides_from_any_distance(size, away):
    """A millimetre's box from 10 km away among them, and rays that begin on its surface."""
    box = trimesh.creation.box(extents=[size] * 3).subdivide()
    mine = RayMeshIntersector(box)
    origins = [[0.1 * size, 0.2 * size, away * size]]
    places, _, _ = mine.intersects_location(origins, [[0, 0, -1]])
    np.testing.assert_allclose(places[:, 2], [0.5 * size, -0.5 * size], rtol=0, atol=2e-16 * max(away, 1) * size)
    assert len(mine.intersects_location(origins, [[0, 0, -1]], multiple_hits=False)[0]) == 1


def test_a_hit_at_the_start_counts(installed):
    mine = trimesh.creation.box().ray
    origins, directions = [[0.1, 0.2, 0.5]] * 2, [[0, 0, 1], [0, 0, -1]]
    first = mine.intersects_first(origins, directions)
    assert (first >= 0).all() and first[0] == first[1]
    assert mine.intersects_any(origins, directions).all()
    np.testing.assert_array_equal(mine.intersects_id(origins, directions)[1], [0, 1, 1])


def test_what_is_flat_or_means_nothing_hits_nothing(ball):
    mine = RayMeshIntersector(ball)
    origins = [[0, 0, np.nan], [0, 0, 5], [0, 0, 5]]
    directions = [[0, 0, 1], [0, 0, 0], [0, 0, 1]]
    assert not mine.intersects_any(origins, directions).any()
    places, index_ray, index_tri = mine.intersects_location(origins, directions)
    assert places.shape == (0, 3) and index_ray.shape == index_tri.shape == (0,)
    for nothing in ([], np.empty((0, 3))):
        assert mine.intersects_location(nothing, nothing)[0].shape == (0, 3)
        assert mine.intersects_first(nothing, nothing).shape == (0,)
        assert mine.contains_points(nothing).shape == (0,)


def test_an_empty_mesh_has_no_hits():
    mine = RayMeshIntersector(trimesh.Trimesh())
    assert mine.intersects_location([[0, 0, 1]], [[0, 0, 1]])[0].shape == (0, 3)
    assert not mine.contains_points([[0, 0, 0]])[0]


def test_a_change_of_the_mesh_is_noticed(ball):
    mine = RayMeshIntersector(ball)
    ray = [[0.01, 0.02, 5]], [[0, 0, -1]]
    before = mine.intersects_location(*ray)[0]
    scene = mine.scene
    ball.vertices *= 2
    assert mine.scene is scene  # its vertices moved: that is a refit
    np.testing.assert_allclose(np.ptp(mine.intersects_location(*ray)[0][:, 2]), 2 * np.ptp(before[:, 2]), rtol=1e-3)
    ball.vertices[:, 2] += 100
    assert not mine.contains_points([[0, 0, 0]])[0] and mine.contains_points([[0, 0, 100]])[0]
    ball.vertices[:, 2] -= 100
    ball.update_faces(ball.triangles_center[:, 2] < 0)
    assert len(mine.intersects_id(*ray)[0]) == 1
    ball.vertices = np.zeros((0, 3))
    ball.faces = np.zeros((0, 3), int)
    assert not mine.intersects_any(*ray)[0]


def test_wrong_arrays_are_named(ball):
    mine = RayMeshIntersector(ball)
    with pytest.raises(ValueError, match=r"ray_directions has shape \(1, 3\) where ray_origins has \(2, 3\)"):
        mine.intersects_any(np.zeros((2, 3)), np.ones((1, 3)))
    with pytest.raises(kdray.InputError, match=r"ray_origins: the shape is to be \(n, 3\)"):
        mine.intersects_first(np.zeros(3), np.ones(3))
    with pytest.raises(kdray.InputError, match=r"points: the shape is to be \(n, 3\)"):
        mine.contains_points(np.zeros((4, 2)))
    with pytest.raises(kdray.InputError, match="points: numbers are wanted"):
        mine.contains_points([["a", "b", "c"]])


def test_it_can_be_copied_and_pickled(ball):
    mine = RayMeshIntersector(ball, scale_to_box=False)
    ray = [[0.1, 0.2, 5]], [[0, 0, -1]]
    expected = mine.intersects_first(*ray)
    for other in (pickle.loads(pickle.dumps(mine)), copy.copy(mine), copy.deepcopy(mine)):
        np.testing.assert_array_equal(other.intersects_first(*ray), expected)
    assert "1280 triangles" in repr(mine)
    assert RayMeshIntersector(geometry=ball).mesh is ball


def test_threads_may_ask_at_once(ball, rng):
    rays = some_rays(rng)
    mine = RayMeshIntersector(ball)
    answers = []
    threads = [threading.Thread(target=lambda: answers.append(mine.intersects_location(*rays)[0])) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(answers) == 4
    for answer in answers:
        np.testing.assert_array_equal(answer, answers[0])


# ---- Installed


def test_install_makes_it_every_meshs_engine():
    before = trimesh.ray.ray_pyembree, trimesh.ray.has_embree, type(trimesh.creation.box().ray)
    engine.install()
    engine.install()
    try:
        for mesh in (trimesh.creation.box(), trimesh.creation.box(use_embree=False), trimesh.primitives.Sphere()):
            assert type(mesh.ray) is RayMeshIntersector
            assert type(mesh.copy().ray) is RayMeshIntersector
        assert trimesh.ray.has_embree
        assert trimesh.ray.ray_pyembree.RayMeshIntersector is RayMeshIntersector
    finally:
        engine.uninstall()
        engine.uninstall()
    assert (trimesh.ray.ray_pyembree, trimesh.ray.has_embree, type(trimesh.creation.box().ray)) == before


def test_trimeshs_own_functions_follow(installed, rng):
    ball = trimesh.creation.icosphere(subdivisions=3)
    points = rng.uniform(-1, 1, (200, 3))
    radius = np.linalg.norm(points, axis=1)
    sure = abs(radius - 1) > 0.02
    np.testing.assert_array_equal(ball.contains(points)[sure], radius[sure] < 1)
    thickness = trimesh.proximity.thickness(ball, ball.triangles_center[:5] * 0.999, method="ray")
    np.testing.assert_allclose(thickness, 2, atol=0.05)
    voxels = trimesh.voxel.creation.voxelize_ray(ball, 0.1)
    assert voxels.filled_count > 500


def test_pyvista_follows(installed):
    pyvista = pytest.importorskip("pyvista")
    ball = pyvista.Sphere(radius=0.5)
    places, rays, cells = ball.multi_ray_trace([[0, 0, 0]] * 3, np.eye(3), first_point=True)
    np.testing.assert_allclose(places, 0.5 * np.eye(3), atol=0.01)
    np.testing.assert_array_equal(rays, [0, 1, 2])
    assert len(cells) == 3
    _, rays, _ = ball.multi_ray_trace([[0.01, 0.02, 3]], [[0, 0, -1]])
    np.testing.assert_array_equal(rays, [0, 0])


def test_it_stands_in_for_embreex_where_that_is_missing(tmp_path):
    (tmp_path / "embreex.py").write_text("raise ImportError('not here')")
    program = f"""
import sys
sys.path.insert(0, {str(tmp_path)!r})
import trimesh, kdray.trimesh
assert not trimesh.ray.has_embree
kdray.trimesh.install()
import trimesh.ray.ray_pyembree as again
assert again.RayMeshIntersector is kdray.trimesh.RayMeshIntersector and trimesh.ray.has_embree
assert trimesh.creation.box().ray.intersects_any([[0, 0, 5]], [[0, 0, -1]])[0]
kdray.trimesh.uninstall()
assert not trimesh.ray.has_embree and "trimesh.ray.ray_pyembree" not in sys.modules
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
