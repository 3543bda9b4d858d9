"""Every example runs from an empty folder, and what it finds out is true."""

import importlib.util
import os
import pathlib
import struct
import subprocess
import sys
from types import ModuleType

import numpy as np
import pytest

import kdray

FOLDER = pathlib.Path(__file__).parents[1] / "examples"
SMALL = {
    "lidar_terrain": ["--beams", "8", "--steps", "90"],
    "line_of_sight": ["--masts", "40", "--size", "60"],
    "sun_hours": ["--minutes", "60", "--width", "80"],
    "thickness": ["--width", "80"],
    "transport": ["--particles", "3000", "--size", "80"],
    "turntable": ["--views", "6", "--size", "20"],
}


def load(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def start(name: str, folder: pathlib.Path, *more: str) -> str:
    """The example as a program, in an empty folder; what it says."""
    command = [sys.executable, str(FOLDER / f"{name}.py"), *SMALL[name], *more]
    where = str(pathlib.Path(kdray.__file__).absolute().parents[1])  # whatever PYTHONPATH says from here
    environment = {**os.environ, "PYTHONPATH": where}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def png_size(path: pathlib.Path) -> tuple[int, int]:
    head = path.read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = struct.unpack(">II", head[16:24])
    return width, height


def box_file(path: pathlib.Path, low: list[float], high: list[float]) -> str:
    """An OBJ of a box whose sides point outwards."""
    corners = [[(low, high)[i >> axis & 1][axis] for axis in range(3)] for i in range(8)]
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    lines = ["v " + " ".join(map(str, corner)) for corner in corners]
    lines += ["f " + " ".join(str(i + 1) for i in quad) for quad in quads]
    path.write_text("\n".join(lines))
    return str(path)


def test_every_example_is_tested() -> None:
    assert {path.stem for path in FOLDER.glob("*.py")} == set(SMALL)


def test_lidar_points_lie_on_the_terrain_to_millimetres(tmp_path: pathlib.Path) -> None:
    said = start("lidar_terrain", tmp_path)
    assert png_size(tmp_path / "lidar_terrain.png") == (840, 480)
    head, _, rows = (tmp_path / "lidar_terrain.ply").read_bytes().partition(b"end_header\n")
    cloud = np.frombuffer(rows, "<f8").reshape(-1, 4)
    assert f"element vertex {len(cloud)}\n".encode() in head
    assert said.startswith(f"{len(cloud)} points of 720 rays")
    assert len(cloud) > 300

    # On the triangles of the terrain, worked out without kdray.
    example = load("lidar_terrain")
    cell = example.SIZE / 399
    x, y = (cloud[:, :2] - [example.WEST, example.SOUTH]).T / cell
    i, j = np.floor(x), np.floor(y)
    fx, fy = x - i, y - j

    def corner(di: int, dj: int) -> np.ndarray:
        return example.height(example.WEST + (i + di) * cell, example.SOUTH + (j + dj) * cell)

    a, c = corner(0, 0), corner(1, 1)
    right = a + fx * (corner(1, 0) - a) + fy * (c - corner(1, 0))
    left = a + fy * (corner(0, 1) - a) + fx * (c - corner(0, 1))
    np.testing.assert_allclose(cloud[:, 2], np.where(fx >= fy, right, left), atol=1e-3)

    # Ranges are distances from one place, the scanner's.
    ends, ranges = cloud[:, :3] - cloud[0, :3], cloud[:, 3]
    system = np.column_stack([2 * ends, np.ones(len(ends))])
    found = np.linalg.lstsq(system, (ends**2).sum(1) - ranges**2, rcond=None)[0]
    np.testing.assert_allclose(np.linalg.norm(ends - found[:3], axis=1), ranges, atol=2e-3)


def test_lidar_takes_a_terrain_of_ones_own(tmp_path: pathlib.Path) -> None:
    start("lidar_terrain", tmp_path, box_file(tmp_path / "hall.obj", [-100, -100, 0], [100, 100, 5]))
    cloud = np.frombuffer((tmp_path / "lidar_terrain.ply").read_bytes().partition(b"end_header\n")[2], "<f8")
    np.testing.assert_allclose(cloud.reshape(-1, 4)[:, 2], 5, atol=1e-5)  # the roof, from 25 m above


def test_the_sun_is_where_it_is() -> None:
    # Reda and Andreas, Solar Position Algorithm (NREL/TP-560-34302), example of appendix A.5: Golden, Colorado.
    to_sun = load("sun_hours").sun(np.array(["2003-10-17T19:30:30"], "datetime64[s]"), 39.742476, -105.1786)[0]
    assert np.linalg.norm(to_sun) == pytest.approx(1)
    assert np.degrees(np.arccos(to_sun[2])) == pytest.approx(50.11162, abs=0.03)  # that one with refraction
    assert np.degrees(np.arctan2(to_sun[0], to_sun[1])) % 360 == pytest.approx(194.34024, abs=0.02)


def test_sun_hours_behind_a_long_wall() -> None:
    example = load("sun_hours")
    scene = kdray.Scene()
    far, tall = 1e5, 10.0
    scene.add_mesh([[-far, 0, 0], [far, 0, 0], [far, 0, tall], [-far, 0, tall]], [[0, 1, 2], [0, 2, 3]])
    noon = np.datetime64("2025-03-05T11:00:00")
    suns = example.sun(noon + np.arange(-720, 720, 10).astype("timedelta64[m]"), 50.0, 15.0)
    depths = np.array([1.0, 5, 12, 18, 30, 200])
    points = np.stack([np.zeros(6), depths, np.zeros(6)], 1)  # north of it
    hours = example.sun_hours(scene, points, np.tile([0.0, 0, 1], (6, 1)), suns, 1 / 6)
    up = suns[suns[:, 2] > 0]
    free = (up[:, 1] >= 0) | (up[:, 2] / np.maximum(-up[:, 1], 1e-9) > (tall - 0.01) / depths[:, None])
    np.testing.assert_allclose(hours, free.sum(1) / 6)
    assert hours[0] < hours[3] < hours[5] <= len(up) / 6


def test_sun_hours_at_equinox(tmp_path: pathlib.Path) -> None:
    assert start("sun_hours", tmp_path).startswith("2025-03-20: 12.0 h between sunrise and sunset")
    assert png_size(tmp_path / "sun_hours.png") == (80, 50)
    midsummer = start("sun_hours", tmp_path, "--date", "2025-06-21", "--latitude", "70")
    assert midsummer.startswith("2025-06-21: 24.0 h")


def test_lines_of_sight_over_a_wall() -> None:
    scene = kdray.Scene()
    scene.add_mesh([[0, -50, 0], [0, 50, 0], [0, 50, 10], [0, -50, 10]], [[0, 1, 2], [0, 2, 3]])
    places = np.array([[-10.0, 0, 2], [-20, 5, 2], [10, 0, 2], [10, 0, 19], [10, 200, 2]])
    matrix = load("line_of_sight").sees(scene, places)
    expected = np.ones((5, 5), bool)
    for a in range(2):  # from the left: not through the wall, but over it and past its end
        for b in range(2, 5):
            share = places[a, 0] / (places[a, 0] - places[b, 0])
            cross = places[a] + share * (places[b] - places[a])
            expected[a, b] = expected[b, a] = not (abs(cross[1]) < 50 and cross[2] < 10)
    assert not expected.all() and expected[0, 3] and expected[1, 4]
    np.testing.assert_array_equal(matrix, expected)


def test_lines_of_sight_of_the_landscape(tmp_path: pathlib.Path) -> None:
    assert start("line_of_sight", tmp_path).startswith("40 masts: ")
    assert png_size(tmp_path / "line_of_sight.png") == (128, 60)

    example = load("line_of_sight")
    vertices, triangles = example.landscape(60)
    scene = kdray.Scene()
    scene.add_mesh(vertices, triangles)
    masts = vertices[np.random.default_rng(1).choice(len(vertices), 50, replace=False)] + np.array([0, 0, 5])
    matrix = example.sees(scene, masts)
    np.testing.assert_array_equal(matrix, matrix.T)
    assert 0.05 < matrix.mean() < 0.9
    # Sampled along the lines: where one is deep in the ground, it is blocked; where it is well above, it isn't.
    grid = vertices[:, 2].reshape(60, 60)
    share = np.linspace(0, 1, 400)[:, None]
    for a, b in zip(*np.tril_indices(50, -1), strict=True):
        line = masts[a] + share * (masts[b] - masts[a])
        column, row = line[:, 0] / 2000 * 59, line[:, 1] / 2000 * 59
        i, j = np.minimum(column.astype(int), 58), np.minimum(row.astype(int), 58)
        around = np.stack([grid[j, i], grid[j, i + 1], grid[j + 1, i], grid[j + 1, i + 1]])
        if (line[:, 2] < around.min(0)).any():
            assert not matrix[a, b]
        if (line[:, 2] > around.max(0)).all():
            assert matrix[a, b]


def test_thickness_of_a_shell_that_is_off_its_centre() -> None:
    example = load("thickness")
    scene = kdray.Scene()
    scene.add_spheres([[0, 0, 0]], [1])  # exact ones: walls are known in closed form
    towards = np.random.default_rng(2).normal(size=(5000, 3))
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    np.testing.assert_allclose(example.thickness(scene, towards, towards), 2, rtol=1e-5)


@pytest.mark.parametrize("away", [0.0, 5e6])
def test_thickness_of_every_face(away: float) -> None:
    example = load("thickness")
    vertices, triangles = example.cup(48)
    vertices = vertices + away
    scene = kdray.Scene()
    scene.add_mesh(vertices, triangles)
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    real = np.linalg.norm(normals, axis=1) > 1e-6
    centres, normals = corners.mean(1)[real], normals[real]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    walls = example.thickness(scene, centres, normals)
    assert np.isfinite(walls).all()
    assert walls.min() > 0.01  # never the face that the ray starts at

    # The nearest other side along each ray by brute force, its own face left out.
    own = np.flatnonzero(real)
    for k in range(0, len(own), 37):
        p, d = centres[k], -normals[k]
        e1, e2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        h = np.cross(d, e2)
        with np.errstate(divide="ignore", invalid="ignore"):
            f = 1 / (e1 * h).sum(1)
            s = p - corners[:, 0]
            u, q = f * (s * h).sum(1), np.cross(s, e1)
            v, t = f * (q @ d), f * (e2 * q).sum(1)
            good = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0) & (np.arange(len(t)) != own[k])
        assert walls[k] == pytest.approx(t[good].min(), rel=1e-4)


def test_thickness_of_a_slab(tmp_path: pathlib.Path) -> None:
    assert start("thickness", tmp_path).splitlines()[-1].startswith("median ")
    assert png_size(tmp_path / "thickness.png") == (80, 60)
    said = start("thickness", tmp_path, box_file(tmp_path / "slab.obj", [0, 0, 0], [400, 300, 7]))
    assert "median 7, thinnest 7;" in said


@pytest.mark.parametrize("depth", [0.3, 1.0, 4.0])  # mean free paths to a radius
def test_particles_leave_an_absorbing_ball(depth: float) -> None:
    example = load("transport")
    scene, rng, n = kdray.Scene(), np.random.default_rng(3), 100000
    scene.add_spheres([[0, 0, 0]], [1.5])
    sides, total = np.array([[1, 0]]), np.array([0, depth / 1.5])
    points = example.points_in(scene, sides, 1, n, rng)
    flown, ends, lost, _ = example.walk(scene, sides, points, np.ones(n, int), total, np.ones(2), rng)
    # Case, de Hoffmann, Placzek, Introduction to the Theory of Neutron Diffusion, 1953: a sphere's escape probability.
    leave = 3 / (8 * depth**3) * (2 * depth**2 - 1 + (1 + 2 * depth) * np.exp(-2 * depth))
    assert 1 - ends[1] / n == pytest.approx(leave, abs=4 * (leave * (1 - leave) / n) ** 0.5)
    assert flown[1] * total[1] == pytest.approx(ends[1], rel=0.03)  # as many collide as their way is long
    assert flown[0] == ends[0] == lost == 0


def test_particles_that_nothing_stops_fly_straight_through_all_volumes() -> None:
    example = load("transport")
    scene, rng = kdray.Scene(geometry="double"), np.random.default_rng(4)
    for size in (1.0, 2.0, 8.0):
        scene.add_mesh(*example.box(size))
    sides = np.array([[3, 2], [2, 1], [1, 0]])
    points = rng.uniform(-0.5, 0.5, (20000, 3))
    np.testing.assert_array_equal(example.volume_of(scene, sides, points), 3)
    np.testing.assert_array_equal(
        example.volume_of(scene, sides, points * 2.5 + [3, 0, 0]),
        np.where((np.abs(points * 2.5 + [3, 0, 0]) < 4).all(1), 1, 0),
    )
    none = np.zeros(4)
    flown, ends, lost, collisions = example.walk(
        scene, sides, points, np.full(len(points), 3), none, none, np.random.default_rng(9)
    )
    assert len(collisions) == ends.sum() == lost == 0
    directions = example.isotropic(np.random.default_rng(9), len(points))
    ways = [((size / 2 - np.sign(directions) * points) / np.abs(directions)).min(1).sum() for size in (1, 2, 8)]
    np.testing.assert_allclose(flown, [0, ways[2] - ways[1], ways[1] - ways[0], ways[0]], rtol=1e-9)


def test_particles_without_a_way_out_are_lost() -> None:
    example = load("transport")
    scene = kdray.Scene()
    scene.add_mesh(example.box(2.0)[0], example.box(2.0)[1][2:])  # open at one end
    scene.add_mesh(*example.box(8.0))
    sides = np.array([[2, 1], [1, 0]])
    none, n = np.zeros(3), 6000
    flown, ends, lost, _ = example.walk(
        scene, sides, np.zeros((n, 3)), np.full(n, 2), none, none, np.random.default_rng(11)
    )
    assert lost == pytest.approx(n / 6, abs=4 * (n * 5 / 36) ** 0.5)  # a sixth of all directions from the middle
    assert ends.sum() == 0 and flown[2] > 0


def test_transport_of_a_core_of_ones_own(tmp_path: pathlib.Path) -> None:
    ring = start("transport", tmp_path)
    assert png_size(tmp_path / "transport.png") == (80, 80)
    cube = start("transport", tmp_path, box_file(tmp_path / "cube.obj", [-1, -1, -1], [1, 1, 1]))
    for said in (ring, cube):
        shares = [float(line.split("%")[0].split()[-1]) for line in said.splitlines()]
        assert len(shares) == 4 and sum(shares) == pytest.approx(100, abs=0.3)
        assert " 0 are lost" in said
    assert cube != ring
    (tmp_path / "far.obj").write_text((tmp_path / "cube.obj").read_text().replace("v -1", "v 5").replace("v 1", "v 6"))
    with pytest.raises(SystemExit, match="none of 100,000 points is in the core"):
        load("transport").main([str(tmp_path / "far.obj"), "-o", str(tmp_path / "no.png")])
    assert not (tmp_path / "no.png").exists()


def test_the_turntable_goes_around(tmp_path: pathlib.Path) -> None:
    start("turntable", tmp_path)
    assert png_size(tmp_path / "turntable.png") == (60, 40)
    start("turntable", tmp_path, "--frames", "-o", "frame.png")
    assert sorted(p.name for p in tmp_path.glob("frame-*")) == [f"frame-00{i}.png" for i in range(6)]


@pytest.mark.parametrize(("up", "level"), [("z", [0, 1]), ("y", [0, 2])])
def test_the_turntable_sees_all_of_it_from_everywhere(up: str, level: list[int]) -> None:
    scene = kdray.Scene()
    scene.add_spheres([[3, -2, 1]], [2])
    cameras = list(load("turntable").cameras(scene, 4, up))
    for camera in cameras:
        assert np.linalg.norm(np.subtract(camera.origin, [3, -2, 1])) == pytest.approx(2 * 3**0.5 / np.sin(np.pi / 12))
        seen = scene.closest_hit(*kdray.pinhole_rays(camera, 40, 40, dtype=np.float64)).hit
        assert seen.any()
        assert not (seen[0].any() or seen[-1].any() or seen[:, 0].any() or seen[:, -1].any())
    middle = np.mean([camera.origin for camera in cameras], axis=0)
    np.testing.assert_allclose(middle[level], np.array([3, -2, 1])[level], atol=1e-6)
    assert middle["xyz".index(up)] > [3, -2, 1]["xyz".index(up)]  # looked down at
