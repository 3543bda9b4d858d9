import json
import xml.etree.ElementTree
from collections.abc import Iterable

import numpy as np
import pytest

import kdray
from kdray import bench
from kdray.bench import aimed, command
from kdray.bench.machine import module

TINY = ["--rays", "400", "--points", "60", "--rounds", "2", "--batches", "1,100"]


def installed(names: Iterable[str] = bench.ENGINES) -> list[str]:
    return [name for name in names if all(module(m) is not None for m in bench.NEEDS[name])]


@pytest.fixture(params=["sphere", "room"])
def small(request: pytest.FixtureRequest) -> bench.Mesh:
    return bench.sphere(24) if request.param == "sphere" else bench.room(40)


def test_the_built_in_meshes_are_closed(small: bench.Mesh) -> None:
    t = small.triangles
    edges = np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
    there = set(map(tuple, edges.tolist()))
    assert len(there) == len(edges)
    assert {(b, a) for a, b in there} == there


def test_the_built_in_meshes_are_of_the_size_that_is_said() -> None:
    assert len(bench.sphere(64).triangles) == 2 * 64 * 63
    assert len(bench.room(100).triangles) == 12 * 101


def test_triangles_point_outwards(small: bench.Mesh) -> None:
    corners = small.vertices[small.triangles].astype(np.float64)
    assert np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() > 0  # the volume


@pytest.mark.parametrize("name", bench.CLASSES)
def test_rays_are_of_unit_length_and_hit_something(small: bench.Mesh, name: str) -> None:
    scene = kdray.Scene()
    scene.add_mesh(small.vertices, small.triangles)
    query = bench.make_rays(small, scene, name, 500)
    assert query.directions is not None
    assert query.origins.shape == query.directions.shape == (500, 3)
    assert query.origins.dtype == query.directions.dtype == np.float32
    np.testing.assert_allclose(np.linalg.norm(query.directions, axis=1), 1, rtol=1e-6)
    t = scene.closest_hit(query.origins, query.directions).t
    assert np.count_nonzero(t < np.inf) > 10  # a ball's own bumps hide little of the sky
    assert 0.3 < np.mean(t[t < np.inf] < query.t_max) < 0.7
    if name == "diffuse" and small.name == "room":
        assert np.count_nonzero(t == np.inf) <= 2  # nothing leaves the room, but for rays from its edges


def test_points_lie_in_the_box_and_a_little_around(small: bench.Mesh) -> None:
    points = bench.make_points(small, 1000).origins
    low, high = small.ends
    inside = ((points > low) & (points < high)).all(axis=1)
    assert 0.6 < inside.mean() < 1


def test_what_counts_as_different() -> None:
    ours = bench.Answer(np.array([1.0, 1, 1, np.inf, np.inf]), np.array([3, 3, 3, -1, -1]))
    theirs = bench.Answer(np.array([1.0, 1, 1.5, 2, np.inf]), np.array([3, 4, 4, 5, -1]))
    assert bench.different(ours, theirs, 1.0) == 2  # a farther triangle, and a hit where there is none
    assert bench.different(ours, ours, 1.0) == 0
    booleans = np.array([True, False]), np.array([True, True])
    assert bench.different(bench.Answer(booleans[0]), bench.Answer(booleans[1]), 1.0) == 1
    distances = np.array([0.5, -0.5, 1]), np.array([0.5, 0.5, np.nan])
    assert bench.different(bench.Answer(distances[0]), bench.Answer(distances[1]), 1.0) == 2


@pytest.mark.parametrize("name", bench.KINDS)
def test_each_engine_answers_as_kdray_does(small: bench.Mesh, name: str) -> None:
    if name not in installed(bench.KINDS):
        pytest.skip(f"{name} is not installed")
    ours = bench.Kdray(small, 1)
    engine = bench.KINDS[name](small, 1)
    rays = bench.make_rays(small, ours.scene, "random", 2000)
    points = bench.make_points(small, 300)
    for task in engine.tasks:
        query = rays if task in bench.RAY_TASKS else points
        expected = ours.answer(task, query, ours.run(task, ours.prepare(task, query)))
        answer = engine.answer(task, query, engine.run(task, engine.prepare(task, query)))
        assert len(answer.values) == len(query)
        assert bench.different(expected, answer, small.size) <= 2, task


def test_the_table_and_the_files(tmp_path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(command, "BUILT_IN", {"sphere": lambda: bench.sphere(24)})
    figures, picture = tmp_path / "bench.json", tmp_path / "bench.svg"
    assert bench.main([*TINY, "--threads", "1", "--json", str(figures), "--plot", str(picture)]) == 0

    told = json.loads(figures.read_text())
    assert told["rays"] == 400
    assert told["versions"]["numpy"] == np.__version__
    assert {row["engine"] for row in told["rows"]} == set(installed())
    asked = {(row["task"], row["rays"], row["batch"]) for row in told["rows"] if row["engine"] == "kdray"}
    rays = {(t, c, b) for t in bench.RAY_TASKS for c in bench.CLASSES for b in (1, 100, 400)}
    assert asked == rays | {(t, "points", b) for t in bench.POINT_TASKS for b in (1, 60)}
    for row in told["rows"]:
        assert row["median"] > 0
        assert len(row["seconds"]) == len(row["cpu_seconds"]) == 2
        assert row["threads"] == 1
        if row["engine"] == "kdray":
            assert row["times_kdray"] == row["cpu_times_kdray"] == 1
        elif row["batch"] in (60, 400):
            assert row["different"] <= 1

    table = capsys.readouterr().out
    assert table.count("closest, primary") == 1
    assert sum(line.startswith(bench.ENGINES) for line in table.splitlines()) >= len(told["rows"])
    root = xml.etree.ElementTree.parse(picture).getroot()
    bars = [node for node in root.iter() if node.tag.endswith("rect") and node.get("fill") != "white"]
    assert len(bars) == sum(row["batch"] in (60, 400) for row in told["rows"])


def test_engines_that_are_missing_are_left_out(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(command, "module", lambda name: None)
    monkeypatch.setattr(command, "BUILT_IN", {"sphere": lambda: bench.sphere(12)})
    assert bench.main([*TINY, "--tasks", "closest", "--classes", "random"]) == 0
    table = capsys.readouterr().out
    assert "left out: open3d: open3d can't be imported" in table
    assert "left out: embreex: embreex can't be imported" in table
    assert "\nkdray " in table
    assert "\nopen3d " not in table


def test_a_mesh_file(tmp_path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("trimesh")
    mesh = bench.sphere(12)
    lines = [f"v {x} {y} {z}" for x, y, z in mesh.vertices.tolist()]
    lines += ["f " + " ".join(str(i + 1) for i in triangle) for triangle in mesh.triangles.tolist()]
    path = tmp_path / "ball.obj"
    path.write_text("\n".join(lines))
    read = bench.read(str(path))
    np.testing.assert_array_equal(read.triangles, mesh.triangles)
    assert bench.main([str(path), *TINY, "--tasks", "occlusion", "--classes", "primary"]) == 0
    assert f"ball.obj ({len(mesh.triangles)} triangles), occlusion, primary" in capsys.readouterr().out


def test_aimed_rays_go_where_they_are_said_to(small: bench.Mesh) -> None:
    for mesh in (small, aimed.in_doubles(small, 1)):
        n = 300
        query = aimed.aim(mesh, n, 5)
        assert query.directions is not None
        assert query.origins.dtype == query.directions.dtype == mesh.vertices.dtype
        vertices, last_place = mesh.vertices.astype(np.float64), np.finfo(mesh.vertices.dtype).eps
        corners = vertices[mesh.triangles]
        starts, along = (a.reshape(4, n, 3).astype(np.float64) for a in (query.origins, query.directions))
        edges = corners[:, 1] - corners[:, 0]
        normals = np.cross(edges, corners[:, 2] - corners[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)

        def distance(start: np.ndarray, direction: np.ndarray) -> float:
            return float(np.linalg.norm(np.cross(vertices - start, direction), axis=1).min())  # noqa: B023

        near = 4 * last_place * mesh.size
        for k in (0, 2, 3):
            assert max(distance(*ray) for ray in zip(starts[k], along[k], strict=True)) < near
        for start, direction in zip(starts[1], along[1], strict=True):
            across = np.cross(direction, edges)
            across /= np.linalg.norm(across, axis=1, keepdims=True)
            assert np.abs(np.einsum("ij,ij->i", corners[:, 0] - start, across)).min() < near
        zero = along[2] == 0
        assert zero.any(axis=1).all()
        for i, axis in zip(*np.nonzero(zero), strict=True):
            assert starts[2][i, axis] in vertices[:, axis]
        assert all(np.abs(normals @ direction).min() < 300 * last_place for direction in along[3])


def test_doubles_are_no_floats_and_round_to_those_they_come_from(small: bench.Mesh) -> None:
    doubles = aimed.in_doubles(small, 1).vertices
    assert np.mean(doubles == doubles.astype(np.float32)) < 0.2  # 0 is one
    places = np.abs(doubles.astype(np.float32).view(np.int32) - small.vertices.view(np.int32))
    assert places.max() <= 1


def test_kdrays_double_geometry_has_no_wrong_hit_and_others_are_judged_by_what_they_say(small: bench.Mesh) -> None:
    for found in aimed.run(small, ["kdray", "kdray-double"], 250, 1, 1, 20261127):
        floats, doubles = found["rows"]
        assert floats["rays"] == 1000
        assert floats["judged"] > 900
        for kind in ("lost", "false", "other", "parity"):
            assert doubles[kind] == [0, 0, 0, 0], (kind, found["numbers"])
        assert doubles["t_off"]["largest"] <= 2**-51  # two last places
        assert 0 < floats["t_off"]["median"] < 2**-22
        assert sum(floats["other"]) > 0  # neighbours, where a ray passes a vertex by less than floats can tell
        assert found["numbers"] == "double" or floats["parity"][:3] == [0, 0, 0]


def test_what_counts_as_wrong_of_aimed_rays() -> None:
    # A square of two triangles; rays down to its diagonal, into a triangle, past it, and along it.
    vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
    square = bench.Mesh("square", vertices, np.array([[0, 1, 2], [0, 2, 3]]), kdray.Camera((0, 0, 1)))
    origins = np.array([[0.5, 0.5, 1], [0.75, 0.25, 2], [1.5, 0.5, 1], [-1, 0.5, 0]], np.float32)
    directions = np.array([[0, 0, -1], [0, 0, -1], [0, 0, -1], [1, 0, 0]], np.float32)
    right = aimed.Right(square, bench.Query(origins, directions))
    assert right.t.tolist() == [1, 2, np.inf, np.inf]
    assert right.sure.tolist() == [True, True, True, False]

    def judged(t: list[float], primitive: list[int], count: list[int]) -> list[list[int]]:
        found = right.judge(bench.Answer(np.array(t), np.array(primitive)), np.array(count))
        return [found[kind] for kind in ("lost", "false", "other", "parity")]

    none, inf = [0, 0, 0, 0], np.inf
    for either in (0, 1):
        assert judged([1, 2, inf, inf], [either, 0, -1, -1], [1, 1, 0, 0]) == [none] * 4
        assert judged([1, 2, inf, 1], [either, 0, -1, 0], [1, 3, 2, 1]) == [none] * 4
    assert judged([inf, 2, 1, inf], [-1, 1, 0, -1], [2, 0, 1, 0]) == [
        [1, 0, 0, 0],
        [0, 0, 1, 0],
        [0, 1, 0, 0],
        [1, 1, 1, 0],
    ]
    off = right.judge(bench.Answer(np.array([1.5, 2, inf, inf]), np.array([0, 0, -1, -1])), None)
    assert off["parity"] is None
    assert off["t_off"] == {"median": 0.25, "largest": 0.5}


def test_aimed_rays_from_the_command_line(tmp_path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("trimesh")
    mesh = bench.sphere(8)
    path, figures = tmp_path / "ball.obj", tmp_path / "aimed.json"
    lines = [f"v {x} {y} {z}" for x, y, z in mesh.vertices.tolist()]
    lines += ["f " + " ".join(str(i + 1) for i in triangle) for triangle in mesh.triangles.tolist()]
    path.write_text("\n".join(lines))
    options = ["--aimed", "--rays", "93", "--rounds", "1", "--json", str(figures)]
    assert bench.main([str(path), *options]) == 0
    out = capsys.readouterr().out
    told = json.loads(figures.read_text())
    assert told["command"] == "bench aimed"
    assert [run["numbers"] for run in told["runs"]] == ["float", "double"]
    for run in told["runs"]:
        assert [row["engine"] for row in run["rows"]] == installed(bench.KINDS)
        assert all(row["seconds"] > 0 for row in run["rows"])
        assert {row["engine"]: row["rays"] for row in run["rows"]}.get("trimesh-own", 40) == 40  # every tenth
        assert f"ball.obj (112 triangles), {run['numbers']} coordinates" in out
    for name in set(bench.KINDS) - set(installed(bench.KINDS)):
        assert f"left out: {name}:" in out


def test_what_is_wrong_is_said_before_anything_is_measured(tmp_path, capsys: pytest.CaptureFixture[str]) -> None:
    assert bench.main(["no-such-scene"]) == 2
    assert "no such file" in capsys.readouterr().err
    assert bench.main(["--json", str(tmp_path / "no" / "bench.json")]) == 2
    assert "no such folder" in capsys.readouterr().err
    for wrong in (["--rays", "0"], ["--tasks", "dance"], ["--batches", "1,x"]):
        with pytest.raises(SystemExit):
            bench.main(wrong)
