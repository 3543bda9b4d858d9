import json
import os
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import kdray
from kdray import bench
from kdray.bench import campaign, leaving
from kdray.bench.exact import Exact

N = len(campaign.MESHES) + 1  # kinds of scenes


def line(seed: int, **differences: int) -> dict[str, Any]:
    about = {"unit": seed, "kdray": "1.0", "device": "a device", "scene": "some", "scale": 1.0}
    return {**about, "rays": 100, "exact": 10, "differences": differences}


def stand_in(monkeypatch: pytest.MonkeyPatch, run: Any = None) -> None:
    """Units that take no time."""
    monkeypatch.setattr(campaign, "make", lambda seed, rays, files: SimpleNamespace(seed=seed))
    monkeypatch.setattr(campaign, "run", run or (lambda unit: line(unit.seed)))


# ---- Units


def test_a_seed_is_a_unit_of_any_kind_and_size_with_rays_from_outside() -> None:
    scales = []
    for seed in range(4 * N):
        unit, again = (campaign.make(seed, 80) for _ in range(2))
        assert unit.objects == again.objects
        np.testing.assert_array_equal(unit.rays.origins, again.rays.origins)
        assert unit.name == [*campaign.MESHES, "shapes"][seed % N]
        assert np.isfinite(unit.rays.origins).all() and len(unit.rays) == 80
        scales.append(unit.scale)
        if unit.mesh is None:
            centers = np.array([o.get("center", o.get("base")) for o in unit.objects])
            away = np.linalg.norm(unit.rays.origins[:, None] - centers, axis=2)
            assert away.min() > 2 * unit.scale  # of which the largest shape has 0.6
        else:
            assert unit.closed
            assert unit.mesh.vertices.dtype == (np.float64 if seed // N % 2 else np.float32)
            low, high = unit.mesh.ends
            assert ((unit.rays.origins < low) | (unit.rays.origins > high)).any(axis=1).all()
    assert min(scales) < 1e-15 and max(scales) > 1e15


def test_rays_go_where_surfaces_are_and_cross_closed_ones_an_even_number_of_times() -> None:
    for seed in (2, 3):
        unit = campaign.make(seed, 80)
        assert unit.mesh is not None and unit.rays.directions is not None
        given = unit.rays.of(np.float64)
        _, _, crossings, along = Exact(unit.mesh.vertices, unit.mesh.triangles).ask(given.origins, given.directions)
        assert (crossings[~along] % 2 == 0).all()
        assert np.mean(crossings > 0) > 0.5


@pytest.mark.parametrize("seed", [0, 1, 2 + N, 3, 4 + N, 5, 5 + N])
def test_kdray_has_no_differences(seed: int) -> None:
    record = campaign.run(campaign.make(seed, 400))
    assert record["differences"] == {}
    assert record["rays"] > 2000
    assert record["exact"] > 10 or record["scene"] == "shapes"


def test_a_mesh_file_is_a_kind_and_an_open_one_has_no_parity() -> None:
    mesh = bench.sphere(8)
    whole = bench.Mesh("ball.obj", mesh.vertices, mesh.triangles, mesh.camera)
    holed = bench.Mesh("bowl.obj", mesh.vertices, mesh.triangles[1:], mesh.camera)
    units = [campaign.make(seed, 40, [whole, holed]) for seed in (N, N + 1, N + 2)]
    assert [unit.name for unit in units] == ["ball.obj", "bowl.obj", "crumpled"]
    assert [unit.closed for unit in units] == [True, False, True]
    assert campaign.run(units[1])["differences"] == {}


def test_forms_that_disagree_are_counted() -> None:
    hits = SimpleNamespace(t=np.array([1.0, 2, np.inf, np.inf]))
    every = SimpleNamespace(splits=np.array([0, 2, 4, 4, 4]), t=np.array([1.0, 3, 5, 4]))
    answers = {
        "closest_hit": hits,
        "any_hit": np.array([True, False, False, False]),  # one is wrong
        "count_hits": np.array([2, 1, 0, 2]),  # odd; and two where nothing is hit
        "all_hits": every,  # two in place of one, and none of two; unsorted; the first isn't the closest
    }
    scene: Any = SimpleNamespace(**{name: lambda *_, a=a, **__: a for name, a in answers.items()})
    query = bench.Query(np.zeros((4, 3)), np.ones((4, 3)))
    found: campaign.Counter[str] = campaign.Counter()
    campaign._ask(scene, query, True, "double", found)
    expected = {"odd": 1, "any": 1, "count": 1, "all": 2, "unsorted": 1, "first of all": 1}
    assert found == {f"double: {name}": n for name, n in expected.items()}


def test_wrong_answers_about_a_sample_are_counted() -> None:
    mesh = bench.sphere(8)
    smaller = kdray.Scene(geometry="double")
    smaller.add_mesh(mesh.vertices * 0.9, mesh.triangles)
    found: campaign.Counter[str] = campaign.Counter()
    assert campaign._hold_against_exact(smaller, mesh, 1, found) > 10
    assert found["exact: lost"] + found["exact: other"] > 0
    assert found["exact: t"] == 1


def test_a_verify_that_fails_is_a_difference(tmp_path: Path) -> None:
    found: campaign.Counter[str] = campaign.Counter()
    (tmp_path / "unit.json").write_text("{")
    assert campaign._verify(tmp_path / "unit.json", 100, found) == ("", 0)
    assert [name.startswith("verify: status 1: kdray: ") for name in found] == [True]


# ---- The ledger


def test_a_campaign_that_was_interrupted_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def run(unit: Any) -> dict[str, Any]:
        if unit.seed == 1:
            raise KeyboardInterrupt
        return line(unit.seed)

    stand_in(monkeypatch, run)
    with pytest.raises(KeyboardInterrupt):
        campaign.go_on(tmp_path / "new", 2, 10)
    assert [record["unit"] for record in campaign.ledger(tmp_path / "new")] == [0]
    assert len(list((tmp_path / "new").iterdir())) == 1  # the other is free, not taken
    stand_in(monkeypatch)
    assert campaign.go_on(tmp_path / "new", 1, 10) == 0
    assert [record["unit"] for record in campaign.ledger(tmp_path / "new")] == [0, 1]


def test_a_damaged_line_is_told_and_its_unit_run_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    stand_in(monkeypatch)
    whole = json.dumps(line(0))
    damaged = [whole[:-9], "[]", "\0", json.dumps(line(0) | {"rays": "1"}), json.dumps(line(0, odd=None))]  # type: ignore[arg-type]
    for seed, text in enumerate(damaged):
        (tmp_path / f"unit-{seed:08}.json").write_text(text)
    (tmp_path / "unit-00000005.json").write_text(json.dumps(line(5, odd=3)))
    assert [record["unit"] for record in campaign.ledger(tmp_path)] == [5]
    campaign.go_on(tmp_path, 6, 10)
    assert capsys.readouterr().out.count("damaged; the unit is run again") == 5
    assert [record["unit"] for record in campaign.ledger(tmp_path)] == [0, 1, 2, 3, 4, 5, 6]
    expected = "7 units, 700 rays, 70 more held against exact arithmetic: 3 odd (kdray 1.0 on a device)"
    assert campaign.totals(tmp_path) == expected


def test_a_folder_is_shared(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with ThreadPoolExecutor(8) as threads:
        taken = list(threads.map(lambda _: campaign.take(tmp_path).name, range(64)))
    assert sorted(taken) == [f"unit-{seed:08}.json" for seed in range(64)]
    assert campaign._age(tmp_path / "gone") == 0 and campaign._read(tmp_path / "gone") == {}

    stand_in(monkeypatch)
    campaign.go_on(tmp_path, 1, 10)  # all before are in work elsewhere
    assert [record["unit"] for record in campaign.ledger(tmp_path)] == [64]
    file = tmp_path / "unit-00000007.json"
    long_ago = file.stat().st_mtime - campaign.GIVEN_UP - 60
    os.utime(file, (long_ago, long_ago))  # whoever took it has gone
    campaign.go_on(tmp_path, 1, 10)
    assert [record["unit"] for record in campaign.ledger(tmp_path)] == [7, 64]


def test_the_command_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    folder = str(tmp_path / "ledger")
    assert bench.main(["--campaign", folder, "--units", "1", "--rays", "200"]) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[0].startswith("unit 1: slivers at ") and told[0].endswith(" rays: no difference")
    assert told[1].startswith("1 units, ") and "exact arithmetic: no difference (kdray " in told[1]

    stand_in(monkeypatch, lambda unit: line(unit.seed, odd=2))
    assert bench.main(["--campaign", folder, "--units", "1", "--seed", "70"]) == 1
    assert "unit 70: some at 1e+00, 100 rays: 2 odd" in capsys.readouterr().out

    def interrupted(unit: Any) -> dict[str, Any]:
        raise KeyboardInterrupt

    stand_in(monkeypatch, interrupted)
    assert bench.main(["--campaign", folder]) == 1
    assert capsys.readouterr().out.startswith("2 units, ")


# ---- Rays that begin on the surface


def test_they_begin_at_vertices_on_edges_and_within() -> None:
    mesh = bench.sphere(6)
    query, begins_at = leaving.leave(mesh, 240, 7)
    assert query.directions is not None and np.isfinite(query.directions).all()
    np.testing.assert_array_equal(query.origins[::4], mesh.vertices[begins_at[::4]])
    assert (begins_at[1::4] == -1).all() and len(set(begins_at[::4].tolist())) > 20
    scene = kdray.Scene()
    scene.add_mesh(mesh.vertices, mesh.triangles)
    assert np.abs(scene.signed_distance(query.origins)).max() < 1e-6


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_answers_of_another_surface_are_wrong(dtype: type[np.floating[Any]]) -> None:
    mesh = bench.sphere(6)
    rays = bench.Query(np.zeros((80, 3)), np.ones((80, 3)))
    unit = campaign.Unit(8, "ball", 1, [], mesh, rays, True)
    geometry = "float" if dtype == np.float32 else "double"
    for size, is_wrong in ((1, False), (1 + 1e-3, True)):
        scene = kdray.Scene(geometry=geometry)
        scene.add_mesh(mesh.vertices.astype(dtype) * dtype(size), mesh.triangles)
        found: Counter[str] = Counter()
        asked, judged = leaving.ask(scene, unit, dtype, found)
        assert bool(sum(found.values())) == is_wrong, found
        assert asked > 4 * leaving.MANY and judged == 0 if dtype == np.float32 else judged > 12
