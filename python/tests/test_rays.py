"""Rays of cameras and scanners."""

import numpy as np
import pytest

import kdray


def test_the_middle_ray_of_a_pinhole_looks_forward():
    o, d = kdray.pinhole_rays(kdray.Camera((1, 2, 3), (1, 2, -7), fov=90), 3, 3)
    np.testing.assert_allclose(d[1, 1], [0, 0, -1], atol=1e-7)
    np.testing.assert_allclose(o, np.broadcast_to([1, 2, 3], (3, 3, 3)))
    np.testing.assert_allclose(d[0, 0], [-2 / 3, 2 / 3, -1], atol=1e-6)


def test_a_sweep_goes_around_and_up():
    o, d = kdray.lidar_rays([[0, 0, 0], [5, 0, 0]], [-10, 0, 10], steps=4)
    assert o.shape == d.shape == (2, 3, 4, 3) and d.dtype == np.float64
    np.testing.assert_allclose(np.linalg.norm(d, axis=-1), 1)
    np.testing.assert_allclose(d[0, 1], [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], atol=1e-15)
    np.testing.assert_allclose(d[1, 2, :, 2], np.sin(np.radians(10)))
    assert (o[1] == [5, 0, 0]).all()


def test_a_scanner_may_be_turned():
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])  # a quarter about z
    _, d = kdray.lidar_rays([0, 0, 0], [0], azimuths=[0], rotations=turn)
    np.testing.assert_allclose(d[0, 0, 0], [0, 1, 0], atol=1e-15)
    with pytest.raises(kdray.InputError, match="rotations"):
        kdray.lidar_rays([0, 0, 0], [0], rotations=np.eye(2))


def test_a_camera_that_looks_nowhere():
    with pytest.raises(kdray.UsageError, match="looks nowhere"):
        kdray.pinhole_rays(kdray.Camera((0, 0, 0), (0, 0, 0)), 4, 4)
    with pytest.raises(kdray.UsageError, match="no pixels"):
        kdray.pinhole_rays(kdray.Camera(), 0, 4)


@pytest.mark.parametrize("fov", [0, 180, 200, -10, float("nan")])
def test_cameras_see_less_than_half_of_the_world(fov):
    camera = kdray.Camera(fov=fov)
    for ask in (lambda: kdray.pinhole_rays(camera, 4, 4), lambda: kdray.Scene().render(camera, (4, 4))):
        with pytest.raises(kdray.errors.UsageError, match="fov"):
            ask()


@pytest.mark.parametrize("steps", [0, -4, 4.5, float("nan"), float("inf")])
def test_a_sweep_has_whole_steps(steps):
    with pytest.raises(kdray.errors.UsageError, match="steps"):
        kdray.lidar_rays([0, 0, 0], [0], steps=steps)
