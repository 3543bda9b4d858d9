"""What docs/sensors.md shows is run, and held against what is known in closed form."""

import pathlib
import textwrap
from typing import Any

import numpy as np
import pytest

import kdray

PAGE = pathlib.Path(__file__).parents[2] / "docs" / "sensors.md"


@pytest.fixture(scope="module")
def page() -> dict[str, Any]:
    """The functions of the page, by name."""
    names: dict[str, Any] = {"np": np, "kdray": kdray}
    blocks = [b for b in PAGE.read_text().split("\n\n") if b.startswith("    def ")]
    assert len(blocks) == 3
    for block in blocks:
        exec(textwrap.dedent(block), names)
    return names


def test_a_sweep_within_a_ball(page: dict[str, Any]) -> None:
    scene = kdray.Scene()
    scene.add_spheres([[1, 2, 3]], [5])
    points, strength, geometry = page["sweep"](scene, [1, 2, 3], np.linspace(-60, 60, 16), 100.0)
    assert len(points) == 16 * 1800 and not geometry.any()
    np.testing.assert_allclose(np.linalg.norm(points - [1, 2, 3], axis=1), 5, rtol=1e-6)
    np.testing.assert_allclose(strength, 1 / 25, rtol=1e-5)
    assert len(page["sweep"](scene, [1, 2, 3], [0.0], 4.0)[0]) == 0  # out of reach


def test_a_corner_sends_waves_back(page: dict[str, Any]) -> None:
    scene = kdray.Scene(geometry="double")
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float) * 1000
    for axis in range(3):
        scene.add_mesh(np.roll(corners, axis, axis=1), [[0, 1, 2], [0, 2, 3]])
    rng = np.random.default_rng(8)
    directions = -rng.uniform(0.3, 1, (5000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    points = rng.uniform(1, 100, (5000, 3)) - 300 * directions  # towards a place near the corner
    going = directions
    for _ in range(3):
        hit, points, going = page["bounce"](scene, points, going, 1e-3)
        assert hit.all()
    np.testing.assert_allclose(going, -directions, atol=1e-12)
    assert not page["bounce"](scene, points, going, 1e-3)[0].any()  # and off they are


def test_volumes_come_in_order(page: dict[str, Any]) -> None:
    scene = kdray.Scene()
    scene.add_spheres([[0, 0, 0]], [1])
    scene.add_spheres([[0, 0, 0]], [2])
    sides = np.array([[0, 1], [1, 2]])
    directions = np.random.default_rng(6).normal(size=(4000, 3))
    points, t = -3 * directions / np.linalg.norm(directions, axis=1, keepdims=True), np.zeros(4000)
    for volume, way in [(1, 1), (0, 2), (1, 4), (2, 5), (-1, np.inf)]:
        t, found = page["next_surface"](scene, sides, points, -points / 3, t)
        np.testing.assert_allclose(t, way, rtol=1e-6)
        np.testing.assert_array_equal(found, volume)
