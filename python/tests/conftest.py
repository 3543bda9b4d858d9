import numpy as np
import pytest

import kdray


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20261124)


@pytest.fixture(scope="session")
def ball_mesh() -> tuple[np.ndarray, np.ndarray]:
    """A closed mesh around a ball of radius 1: vertices on it, triangles counterclockwise from outside."""
    n, m = 48, 24
    theta = np.linspace(0, np.pi, m + 1)[1:-1]
    phi = np.arange(n) * (2 * np.pi / n)
    ring = np.stack(
        [
            np.sin(theta)[:, None] * np.cos(phi),
            np.sin(theta)[:, None] * np.sin(phi),
            np.broadcast_to(np.cos(theta)[:, None], (m - 1, n)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    vertices = np.concatenate([ring, [[0, 0, 1], [0, 0, -1]]])
    top, bottom = len(ring), len(ring) + 1
    triangles = []
    for j in range(n):
        k = (j + 1) % n
        triangles.append((top, j, k))
        triangles.append((bottom, (m - 2) * n + k, (m - 2) * n + j))
        for i in range(m - 2):
            a, b, c, d = i * n + j, i * n + k, (i + 1) * n + j, (i + 1) * n + k
            triangles += [(a, c, b), (b, c, d)]
    return vertices, np.array(triangles)


@pytest.fixture
def ball(ball_mesh: tuple[np.ndarray, np.ndarray]) -> kdray.Scene:
    scene = kdray.Scene()
    scene.add_mesh(*ball_mesh)
    return scene
