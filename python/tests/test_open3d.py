"""RaycastingScene, held against Open3D's own where that is installed."""

import copy
import pickle
import subprocess
import sys

import numpy as np
import pytest

import kdray
from kdray import RaycastingScene

NONE = RaycastingScene.INVALID_ID


@pytest.fixture
def two_balls(ball_mesh):
    """Two closed meshes that don't meet, by vertices and triangles."""
    vertices, triangles = ball_mesh
    small = (0.5 * vertices + [2, 0.3, -0.1]).astype(np.float32)
    return [(vertices.astype(np.float32), triangles.astype(np.uint32)), (small, triangles.astype(np.uint32))]


@pytest.fixture
def scene(two_balls):
    made = RaycastingScene()
    assert [made.add_triangles(*mesh) for mesh in two_balls] == [0, 1]
    return made


@pytest.fixture
def some_rays(rng):
    origins = 2 * rng.normal(size=(500, 3)) + [1, 0, 0]
    aims = rng.normal(size=(500, 3)) * 0.8 + [1, 0, 0]
    lengths = rng.uniform(0.01, 100, (500, 1))
    return np.concatenate([origins, (aims - origins) * lengths], axis=1).astype(np.float32)


@pytest.fixture
def some_points(rng):
    return (rng.uniform(-1, 1, (500, 3)) * [2, 1.2, 1.2] + [1, 0, 0]).astype(np.float32)


# ---- Against Open3D


@pytest.fixture
def open3d():
    return pytest.importorskip("open3d")


@pytest.fixture
def theirs(open3d, two_balls):
    made = open3d.t.geometry.RaycastingScene()
    for vertices, triangles in two_balls:
        made.add_triangles(open3d.core.Tensor(vertices), open3d.core.Tensor(triangles))
    return made


def tensors(open3d, values):
    return open3d.core.Tensor(np.ascontiguousarray(values))


def assert_alike(mine, expected, **close):
    """Of the same kind, names, types, shapes and values."""
    if isinstance(expected, dict):
        assert set(mine) == set(expected)
        for name in expected:
            assert_alike(mine[name], expected[name], **close)
        return
    mine, expected = mine.cpu().numpy(), expected.numpy()
    assert type(mine) is np.ndarray and mine.dtype == expected.dtype and mine.shape == expected.shape
    if expected.dtype.kind == "f":
        np.testing.assert_allclose(mine, expected, **close)
    else:
        np.testing.assert_array_equal(mine, expected)


CLOSE = {"rtol": 2e-5, "atol": 2e-5}


@pytest.mark.parametrize("shape", [(500,), (5, 100), (5, 4, 25), (1, 500)])
def test_rays_are_answered_alike(open3d, scene, theirs, some_rays, shape):
    rays = some_rays.reshape(*shape, 6)
    given = tensors(open3d, rays)
    mine = scene.cast_rays(rays)
    assert 100 < np.isfinite(mine["t_hit"]).sum() < 450 and (mine["geometry_ids"] == 1).any()
    expected = theirs.cast_rays(given)
    assert set(mine) == set(expected)
    for name in ("t_hit", "geometry_ids", "primitive_ids", "primitive_normals"):
        assert_alike(mine[name], expected[name], **CLOSE)
    assert_alike(mine["primitive_uvs"], expected["primitive_uvs"], rtol=0, atol=2e-4)
    assert_alike(scene.test_occlusions(rays), theirs.test_occlusions(given))
    assert_alike(scene.count_intersections(rays), theirs.count_intersections(given))


@pytest.mark.parametrize("limits", [(0.0, 0.5), (0.01, float("inf")), (0.3, 0.2), (0.1, 0.1)])
def test_occlusions_between_limits(open3d, scene, theirs, some_rays, limits):
    assert_alike(scene.test_occlusions(some_rays, *limits), theirs.test_occlusions(tensors(open3d, some_rays), *limits))


def test_crossings_are_listed_alike(open3d, scene, theirs, some_rays):
    rays = some_rays.reshape(20, 25, 6)
    mine, expected = scene.list_intersections(rays), theirs.list_intersections(tensors(open3d, rays))
    uvs = mine.pop("primitive_uvs"), expected.pop("primitive_uvs")
    assert_alike(mine, expected, **CLOSE)
    assert_alike(*uvs, rtol=0, atol=2e-4)


@pytest.mark.parametrize("shape", [(500,), (5, 100), (5, 4, 25)])
def test_points_are_answered_alike(open3d, scene, theirs, some_points, shape):
    points = some_points.reshape(*shape, 3)
    given = tensors(open3d, points)
    mine, expected = scene.compute_closest_points(points), theirs.compute_closest_points(given)
    assert_alike(mine["points"], expected["points"], rtol=0, atol=5e-4)  # Open3D's: mine are within 2e-7 of double's
    assert_alike(mine["geometry_ids"], expected["geometry_ids"])
    same = mine["primitive_ids"] == expected["primitive_ids"].numpy()  # or another one at the same edge
    assert same.mean() > 0.5
    for name in ("primitive_uvs", "primitive_normals"):
        other = expected[name].numpy()
        assert mine[name].dtype == other.dtype and mine[name].shape == other.shape
        np.testing.assert_allclose(mine[name][same], other[same], rtol=0, atol=2e-4)
    assert_alike(scene.compute_distance(points), theirs.compute_distance(given), rtol=0, atol=2e-6)
    assert_alike(scene.compute_signed_distance(points), theirs.compute_signed_distance(given), rtol=0, atol=2e-6)
    occupancy = scene.compute_occupancy(points)
    assert 10 < occupancy.sum() < 490
    assert_alike(occupancy, theirs.compute_occupancy(given))
    assert_alike(scene.compute_occupancy(points, nsamples=3), theirs.compute_occupancy(given, nsamples=3))


def test_an_empty_scene_is_answered_alike(open3d, some_rays, some_points):
    mine, theirs = RaycastingScene(), open3d.t.geometry.RaycastingScene()
    rays, points = tensors(open3d, some_rays), tensors(open3d, some_points)
    for method in ("cast_rays", "test_occlusions", "count_intersections", "list_intersections"):
        assert_alike(getattr(mine, method)(some_rays), getattr(theirs, method)(rays))
    assert_alike(mine.compute_occupancy(some_points), theirs.compute_occupancy(points))
    nearest, expected = mine.compute_closest_points(some_points), theirs.compute_closest_points(points)
    for name in ("geometry_ids", "primitive_ids"):
        assert_alike(nearest[name], expected[name])
    for name in ("points", "primitive_uvs", "primitive_normals"):  # Open3D leaves them as they were
        assert (nearest[name].dtype, nearest[name].shape) == (expected[name].numpy().dtype, expected[name].shape)


def test_no_rays_are_answered_alike(open3d, scene, theirs):
    rays = np.empty((0, 6), np.float32)
    for method in ("cast_rays", "test_occlusions", "count_intersections"):  # its list_intersections dies
        assert_alike(getattr(scene, method)(rays), getattr(theirs, method)(tensors(open3d, rays)))
    assert scene.list_intersections(rays)["ray_splits"].tolist() == [0]
    assert scene.compute_distance(rays[:, :3]).shape == (0,)
    assert scene.compute_closest_points(rays[:, :3])["primitive_uvs"].shape == (0, 2)


def test_limits_are_a_part_of_the_ray(open3d):
    square = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0]], np.float32), np.array([[0, 1, 2]], np.uint32)
    mine, theirs = RaycastingScene(), open3d.t.geometry.RaycastingScene()
    mine.add_triangles(*square)
    theirs.add_triangles(*square)
    rays = np.array([[1, 1, 0, 0, 0, 1], [1, 1, 0, 0, 0, -1], [1, 1, 1, 0, 0, -1]], np.float32)
    given = tensors(open3d, rays)
    assert_alike(mine.cast_rays(rays)["t_hit"], theirs.cast_rays(given)["t_hit"], atol=1e-6)
    for limits in ((0, 1), (0, 0), (0.5, 0.9)):
        assert_alike(mine.test_occlusions(rays, *limits), theirs.test_occlusions(given, *limits))
    assert mine.test_occlusions(rays, 1, 2)[2] and mine.test_occlusions(rays, 1, 1)[2]


def test_cameras_are_alike(open3d):
    their = open3d.t.geometry.RaycastingScene.create_rays_pinhole
    mine = RaycastingScene.create_rays_pinhole
    view = {"fov_deg": 60, "center": [0.1, 0, 0.2], "eye": [1, 2, 5], "up": [0, 1, 0.1], "width_px": 7, "height_px": 4}
    assert_alike(mine(**view), their(**view), atol=1e-6)
    assert_alike(mine(*view.values()), their(*view.values()), atol=1e-6)
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn * np.linalg.det(turn), [3, 4, 5]
    lens = np.array([[100, 0.3, 3.5], [0, 90, 2], [0, 0, 1]])
    assert_alike(mine(lens, pose, 7, 4), their(lens, pose, 7, 4), atol=1e-5)
    named = {"intrinsic_matrix": lens, "extrinsic_matrix": pose, "width_px": 7, "height_px": 4}
    assert_alike(mine(**named), their(**named), atol=1e-5)


def test_tensors_are_answered_by_tensors(open3d, scene, two_balls, some_rays, some_points):
    rays, points = tensors(open3d, some_rays), tensors(open3d, some_points)
    for method, given, array in (
        ("cast_rays", rays, some_rays),
        ("test_occlusions", rays, some_rays),
        ("count_intersections", rays, some_rays),
        ("list_intersections", rays, some_rays),
        ("compute_closest_points", points, some_points),
        ("compute_distance", points, some_points),
        ("compute_signed_distance", points, some_points),
        ("compute_occupancy", points, some_points),
    ):
        answer, expected = getattr(scene, method)(given), getattr(scene, method)(array)
        if not isinstance(answer, dict):
            answer, expected = {"": answer}, {"": expected}
        for name in expected:
            assert isinstance(answer[name], open3d.core.Tensor)
            np.testing.assert_array_equal(answer[name].numpy(), expected[name])
            answer[name][:1] = 0  # it may be written to
    eye = tensors(open3d, np.array([0.0, 0, 5]))
    made = RaycastingScene.create_rays_pinhole(60, [0, 0, 0], eye, [0, 1, 0], 4, 3)
    assert isinstance(made, open3d.core.Tensor) and tuple(made.shape) == (3, 4, 6)


def test_meshes_of_open3d_are_taken(open3d, some_rays):
    old = open3d.geometry.TriangleMesh.create_sphere(1.0)
    new = open3d.t.geometry.TriangleMesh.from_legacy(old)
    answers = []
    for given in ((old,), (new,), (new.vertex.positions, new.triangle.indices)):
        scene = RaycastingScene(device=open3d.core.Device("CPU:0"))
        assert scene.add_triangles(*given) == 0
        answers.append(scene.cast_rays(some_rays)["primitive_ids"])
    assert (answers[0] != NONE).any()
    np.testing.assert_array_equal(answers[0], answers[1])
    np.testing.assert_array_equal(answers[2], answers[1])
    assert RaycastingScene().add_triangles(mesh=new) == 0
    with pytest.raises(kdray.InputError, match="no vertex positions"):
        RaycastingScene().add_triangles(open3d.t.geometry.TriangleMesh())


# ---- Alone


def test_open3d_is_not_imported():
    program = """
import sys, numpy as np, kdray
scene = kdray.RaycastingScene()
scene.add_triangles([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
assert scene.cast_rays([[1, 1, 5, 0, 0, -2]])["t_hit"][0] == 2.5
assert "open3d" not in sys.modules
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr


def test_answers_become_arrays_as_tensors_do(scene, some_rays, some_points):
    rays = RaycastingScene.create_rays_pinhole(60, [0, 0, 0], [0, 0, 5], [0, 1, 0], 8, 6)
    answers = [rays, scene.compute_occupancy(some_points), scene.test_occlusions(rays.numpy())]
    answers += [*scene.cast_rays(rays).values(), *scene.list_intersections(some_rays.tolist()).values()]
    answers += [*scene.compute_closest_points(some_points).values(), scene.compute_distance(some_points)]
    for answer in answers:
        plain = answer.cpu().numpy()
        assert type(plain) is np.ndarray and np.shares_memory(plain, answer)
        assert isinstance(answer, np.ndarray) and isinstance(answer[:1], type(answer))
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(answer)).numpy(), plain)


def test_a_miss_is_told_by_infinity_and_the_invalid_id(scene):
    answer = scene.cast_rays(np.array([[0, 0, 9, 0, 0, 1], [np.nan, 0, 9, 0, 0, -1], [0, 0, 9, 0, 0, 0]], np.float32))
    assert np.isinf(answer["t_hit"]).all()
    assert (answer["geometry_ids"] == NONE).all() and (answer["primitive_ids"] == NONE).all()
    assert (answer["primitive_uvs"] == 0).all() and (answer["primitive_normals"] == 0).all()
    assert kdray.RaycastingScene.INVALID_ID == 2**32 - 1


def test_only_what_is_wanted(scene, some_rays, some_points):
    whole = scene.cast_rays(some_rays)
    for name, values in whole.items():
        (only,) = scene.cast_rays(some_rays, fields=(name,)).items()
        assert only[0] == name
        np.testing.assert_array_equal(only[1], values)
    whole = scene.compute_closest_points(some_points)
    for name, values in whole.items():
        (only,) = scene.compute_closest_points(some_points, fields=(name,)).items()
        assert only[0] == name
        np.testing.assert_array_equal(only[1], values)
    with pytest.raises(kdray.UsageError, match="there is no field 'depth'"):
        scene.cast_rays(some_rays, fields=("depth",))


def test_rays_are_read_where_they_lie(scene, some_rays, monkeypatch):
    seen = []
    core = scene.scene._ready()

    class Spy:
        def closest(self, origins, directions, *rest):
            seen.extend([origins, directions])
            return core.closest(origins, directions, *rest)

    monkeypatch.setattr(scene.scene, "_ready", Spy)
    for rays in (some_rays, some_rays.reshape(20, 25, 6), some_rays[::2]):
        scene.cast_rays(rays)
    assert len(seen) == 6 and all(np.shares_memory(rows, some_rays) for rows in seen)


def test_any_layout_and_type(scene, some_rays):
    expected = scene.cast_rays(some_rays)["primitive_ids"]
    wide = np.zeros((500, 9), np.float32)
    wide[:, 2:8] = some_rays
    for rays in (np.asfortranarray(some_rays), wide[:, 2:8], some_rays.astype(">f4"), some_rays.tolist()):
        answer = scene.cast_rays(rays)
        np.testing.assert_array_equal(answer["primitive_ids"], expected)
        assert answer["t_hit"].dtype == np.float32
    answer = scene.cast_rays(some_rays.astype(np.float64))
    assert answer["t_hit"].dtype == answer["primitive_normals"].dtype == np.float64
    assert (answer["primitive_ids"] == expected).mean() > 0.99


def test_edges_and_vertices_are_crossed_once(scene, two_balls):
    vertices, _ = two_balls[0]
    rays = np.concatenate([np.zeros_like(vertices), -vertices], axis=1)
    one = RaycastingScene()
    one.add_triangles(*two_balls[0])
    assert (one.count_intersections(rays) == 1).all()
    assert np.isfinite(one.cast_rays(rays)["t_hit"]).all()
    assert one.compute_occupancy(0.9 * vertices).all() and not one.compute_occupancy(1.1 * vertices).any()


def test_vertices_in_double_keep_what_float_would_lose(ball_mesh):
    vertices, triangles = ball_mesh
    far = np.array([528980.85, 183526.1, 12.5])
    scene = RaycastingScene()
    scene.add_triangles(vertices + far, triangles)
    ray = np.concatenate([far + [0.01, 0.02, 3], [0, 0, -1]])[None]
    near = RaycastingScene()
    near.add_triangles(vertices, triangles)
    expected = near.cast_rays(np.array([[0.01, 0.02, 3, 0, 0, -1]]))["t_hit"]
    np.testing.assert_allclose(scene.cast_rays(ray)["t_hit"], expected, atol=1e-6)


def test_the_scene_within_can_be_changed(scene, two_balls):
    vertices, _ = two_balls[1]
    point = np.array([[2, 0.3, 0.5]], np.float32)
    up = scene.compute_closest_points(point)
    assert up["geometry_ids"] == 1 and up["primitive_normals"][0, 2] > 0.9
    scene.scene.update_vertices(1, vertices * [1, 1, -1])
    down = scene.compute_closest_points(point)
    assert down["geometry_ids"] == 1 and down["primitive_normals"][0, 2] < -0.9
    scene.scene.enable(1, False)
    assert scene.compute_closest_points(point)["geometry_ids"] == 0


def test_it_can_be_copied_and_pickled(scene, some_rays):
    expected = scene.cast_rays(some_rays)["t_hit"]
    for other in (copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))):
        np.testing.assert_array_equal(other.cast_rays(some_rays)["t_hit"], expected)
    assert repr(scene) == "<kdray.RaycastingScene of 2 meshes, 4416 triangles>"


def test_what_is_wrong_is_named(scene, some_rays, some_points):
    for rays in (some_rays[0], some_rays[:, :5], np.zeros((2, 3, 7))):
        with pytest.raises(kdray.InputError, match=r"rays: the shape is to be \(\.\.\., 6\)"):
            scene.cast_rays(rays)
    with pytest.raises(kdray.InputError, match=r"query_points: the shape is to be \(\.\.\., 3\)"):
        scene.compute_distance(some_points[0])
    with pytest.raises(kdray.InputError, match="rays: numbers are wanted"):
        scene.cast_rays([["a"] * 6])
    for samples in (0, 2, -1):
        with pytest.raises(kdray.UsageError, match="nsamples is to be odd"):
            scene.compute_occupancy(some_points, nsamples=samples)
        with pytest.raises(kdray.UsageError, match="nsamples is to be odd"):
            scene.compute_signed_distance(some_points, nsamples=samples)
    for given in ((), (1, 2, 3), ("nothing",)):
        with pytest.raises(kdray.Error):
            scene.add_triangles(*given)
    with pytest.raises(kdray.InputError, match=r"triangles\[0\]"):
        scene.add_triangles(np.zeros((2, 3), np.float32), [[0, 1, 2]])
    for given in ((60, [0, 0, 0]), (np.eye(3), np.eye(4), 0, 3), (60, [0, 0, 0], [0, 1, 0], [0, 1, 0], 4, 3)):
        with pytest.raises(kdray.UsageError):
            RaycastingScene.create_rays_pinhole(*given)
    with pytest.raises(kdray.InputError, match="extrinsic_matrix"):
        RaycastingScene.create_rays_pinhole(np.eye(3), np.eye(3), 4, 3)
    with pytest.raises(kdray.InputError, match="no inverse"):
        RaycastingScene.create_rays_pinhole(np.zeros((3, 3)), np.eye(4), 4, 3)
    with pytest.raises(AttributeError, match="no attribute 'RayCastingScene'"):
        kdray.RayCastingScene  # noqa: B018
