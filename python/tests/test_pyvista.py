"""pyvista's filters, answered by kdray. Nothing here is random."""

import numpy as np
import pytest

pyvista = pytest.importorskip("pyvista")
kdray_pyvista = pytest.importorskip("kdray.pyvista")


@pytest.fixture
def installed():
    kdray_pyvista.install()
    yield
    kdray_pyvista.uninstall()


@pytest.fixture
def grid():
    return pyvista.ImageData(dimensions=(21, 21, 21), spacing=(0.1,) * 3, origin=(-1,) * 3)


def by_distance(grid, radius):
    return np.linalg.norm(grid.points, axis=1) <= radius


def test_points_inside_of_a_ball(installed, grid):
    ball = pyvista.Sphere(radius=0.75, theta_resolution=200, phi_resolution=200)
    for method in ("signed_distance", "cell_locator"):
        selected = grid.select_interior_points(ball, method=method)
        assert selected["selected_points"].dtype == bool and selected.active_scalars_name == "selected_points"
        np.testing.assert_array_equal(selected["selected_points"], by_distance(grid, 0.75))
        outside = grid.select_interior_points(ball, method=method, inside_out=True)
        np.testing.assert_array_equal(outside["selected_points"], ~by_distance(grid, 0.75))
    assert "selected_points" not in grid.point_data
    enclosed = grid.select_enclosed_points(ball)
    np.testing.assert_array_equal(enclosed["SelectedPoints"], by_distance(grid, 0.75).astype(np.uint8))


def test_points_on_the_surface_are_inside_and_outside(installed):
    box = pyvista.Box((0, 1, 0, 1, 0, 1)).triangulate()
    points = pyvista.PolyData(np.array([[0, 0, 0], [1, 0.5, 0.5], [0.5, 0.5, 0.5], [2, 0, 0]], float))
    assert points.select_interior_points(box)["selected_points"].tolist() == [True, True, True, False]
    assert points.select_interior_points(box, inside_out=True)["selected_points"].tolist() == [True, True, False, True]


def test_what_pyvista_refuses_is_refused(installed, grid):
    open_ball = pyvista.Sphere(end_theta=180)
    with pytest.raises(RuntimeError, match="not closed"):
        grid.select_interior_points(open_ball)
    grid.select_interior_points(open_ball, check_surface=False)
    with pytest.raises(ValueError, match="locator_tolerance"):
        grid.select_interior_points(pyvista.Sphere(), locator_tolerance=0.1)
    with pytest.raises(ValueError, match="method"):
        grid.select_interior_points(pyvista.Sphere(), method="vote")
    with pytest.raises(TypeError, match="PolyData"):
        grid.select_interior_points(grid)


def test_what_is_empty_has_nothing_inside(installed, grid):
    assert not grid.select_interior_points(pyvista.PolyData())["selected_points"].any()
    assert grid.select_interior_points(pyvista.PolyData(), inside_out=True)["selected_points"].all()
    assert len(pyvista.PolyData().select_interior_points(pyvista.Sphere())["selected_points"]) == 0


def test_places_far_from_the_origin_are_told_apart(installed):
    away = np.array([5e5, 5e6, 100.0])
    unit = pyvista.Box((0, 1, 0, 1, 0, 1))  # six quads
    box = pyvista.PolyData(unit.points.astype(float) + away, unit.faces)
    assert box.points.dtype == np.float64
    points = pyvista.PolyData(away + [[0.5, 0.5, 0.5], [1 + 1e-8, 0.5, 0.5], [1 - 1e-8, 0.5, 0.5]])
    for method in ("signed_distance", "cell_locator"):
        selected = points.select_interior_points(box, method=method)["selected_points"]
        assert selected.tolist() == [True, False, True]


def test_pyvistas_own_come_back():
    own = pyvista.DataSetFilters.select_interior_points
    kdray_pyvista.install()
    kdray_pyvista.install()
    assert pyvista.DataSetFilters.select_interior_points is kdray_pyvista.select_interior_points
    kdray_pyvista.uninstall()
    kdray_pyvista.uninstall()
    assert pyvista.DataSetFilters.select_interior_points is own
