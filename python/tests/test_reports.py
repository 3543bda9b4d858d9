"""Faults that were reported of other projects (kdray.bench.reports): kdray's answers, and what is right."""

from fractions import Fraction

import numpy as np
import pytest

from kdray import Scene
from kdray.bench import command, main
from kdray.bench.exact import Exact
from kdray.bench.meshes import ball, cube, nested, octahedron
from kdray.bench.peers import PEERS, Kdray, Peer, TrimeshKdray
from kdray.bench.reports import REPORTS, Case, Report, told

CUBE = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)], np.float32)
SIDES = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
TWELVE = np.concatenate([SIDES[:, :3], SIDES[:, [0, 2, 3]]])


@pytest.mark.parametrize("report", REPORTS, ids=lambda report: report.name)
def test_kdray_is_right(report: Report) -> None:
    assert report.make().ask(Kdray) == 0, f"{', '.join(report.where)}: {report.what}"


@pytest.mark.parametrize("report", REPORTS, ids=lambda report: report.name)
def test_kdray_under_trimesh_is_right(report: Report) -> None:
    for needed in TrimeshKdray.needs:
        pytest.importorskip(needed)
    assert report.make().ask(TrimeshKdray) == 0, f"{', '.join(report.where)}: {report.what}"


def test_corners_rounded_to_float_are_off_by_no_more_than_that() -> None:
    case = next(r for r in REPORTS if r.name == "plane_of_doubles").make()
    scene = Scene()
    scene.add_mesh(case.vertices, case.triangles)
    t = scene.closest_hit(*case.asked).t
    met = np.isfinite(case.right)
    np.testing.assert_array_equal(np.isfinite(t), met)
    # Half a float's last place of 500 in each coordinate, along rays that are at least 0.15 radians above the plane.
    assert np.abs(t[met] - case.right[met]).max() < 3 * 2.0**-16 / 0.15


def test_each_report_is_told_and_each_case_asks_for_more_than_one_answer() -> None:
    assert len(REPORTS) > 20
    assert len({r.name for r in REPORTS}) == len(REPORTS)
    for report in REPORTS:
        case = report.make()
        assert report.where and report.what and len(case.right) >= 60
        assert all(len(asked) == len(case.right) for asked in case.asked)
        if not report.name.startswith("plane_of"):
            for array in (case.vertices, *case.asked):
                np.testing.assert_array_equal(array, np.float32(array))  # who computes in float is given the same


@pytest.mark.parametrize("mesh", [cube(3), octahedron(4), ball(4), nested([3, 2, 1], 2)])
def test_meshes_are_closed_and_face_outwards(mesh: tuple[np.ndarray, np.ndarray]) -> None:
    vertices, triangles = mesh
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    there = set(map(tuple, edges.tolist()))
    assert len(there) == len(edges)
    assert {(b, a) for a, b in there} == there
    corners = vertices[triangles].astype(np.float64)
    assert np.linalg.det(corners).sum() > 0  # six times the volume


# ---- What is right


def test_exact_answers_about_a_cube() -> None:
    cube = Exact(CUBE, TWELVE)
    origins = np.array([[0.5, 0.5, -1], [0.25, 0.75, 2], [0.5, 0.5, 0.5], [-1, -1, -1], [2, 2, 2], [0.5, 3, 0.5]])
    directions = np.array([[0, 0, 1], [0, 0, -2], [1, 1, 1], [1, 1, 1], [1, 0, 0], [0, 0, 1]])
    assert cube.crossings(origins, directions).tolist() == [2, 2, 1, 2, 0, 0]  # through diagonals and corners
    assert cube.first(origins, directions).tolist() == [1, 0.5, 0.5, 1, np.inf, np.inf]
    points = np.array([[-1, -1, 0.5], [0.5, 0.5, 0.5], [4, 5, 0.5], [0.25, 0.5, 0.5], [0.5, 0.5, 1.5]])
    assert cube.inside(points).tolist() == [False, True, False, True, False]
    assert cube.signed_distance(points).tolist() == [2**0.5, -0.5, 5, -0.25, 0.5]


def test_where_a_ray_may_touch_alone() -> None:
    # Along an edge between a front and a back, along one of two fronts, in a side's plane, and through a side.
    origins = np.array([[-1, 0, 0.5], [-1, -1, 0.5], [-1, 0, 0.5], [0.25, 0.5, -1]])
    directions = np.array([[1, 1, 0], [1, 1, 0], [1, 0, 0], [0, 0, 1]])
    t, nearest, crossings, touches = Exact(CUBE, TWELVE).ask(origins, directions)
    assert touches.tolist() == [True, False, True, False]
    assert t.tolist() == [1, 1, 1, 1]
    assert [len(triangles) for triangles in nearest[:2]] == [2, 2]
    assert (crossings % 2 == 0).all()


def test_exact_answers_need_no_scale() -> None:
    for scale in (2.0**-300, 2.0**300):
        cube = Exact(CUBE.astype(np.float64) * scale, TWELVE)
        ray = np.array([[0.5, 0.5, -3]]) * scale, np.array([[0, 0, 1.0]])
        assert cube.crossings(*ray).tolist() == [2]
        assert cube.first(*ray).tolist() == [3 * scale]


def test_exact_hits_are_those_of_fractions() -> None:
    random = np.random.default_rng(20261126)  # the seed
    corners = random.normal(size=(40, 3, 3)).astype(np.float32)
    mesh = Exact(corners.reshape(-1, 3), np.arange(120).reshape(-1, 3))
    origins, directions = random.normal(size=(2, 50, 3)).astype(np.float32)
    expected = []
    for origin, direction in zip(origins, directions, strict=True):
        hits = [crossed(corner, origin, direction) for corner in corners]
        expected.append(sorted(t for t in hits if t is not None))
    assert mesh.crossings(origins, directions).tolist() == [len(ts) for ts in expected]
    assert mesh.first(origins, directions).tolist() == [float(ts[0]) if ts else np.inf for ts in expected]
    assert sum(map(len, expected)) > 50


def crossed(corners: np.ndarray, origin: np.ndarray, direction: np.ndarray) -> Fraction | None:
    """By Cramer's rule: origin + t * direction = a + u * (b - a) + v * (c - a)."""
    o, d, a, b, c = ([Fraction(float(x)) for x in v] for v in (origin, direction, *corners))
    e, f, s = ([y - x for x, y in zip(a, p, strict=True)] for p in (b, c, o))
    minus = [-x for x in d]

    def determinant(p: list[Fraction], q: list[Fraction], r: list[Fraction]) -> Fraction:
        return sum((p[i] * (q[i - 2] * r[i - 1] - q[i - 1] * r[i - 2]) for i in range(3)), Fraction(0))

    whole = determinant(minus, e, f)
    t, u, v = (determinant(*m) / whole for m in ((s, e, f), (minus, s, f), (minus, e, s)))
    return t if t > 0 and u >= 0 and v >= 0 and u + v <= 1 else None


def test_what_counts_as_wrong() -> None:
    three = np.zeros((3, 3), np.float32)
    case = Case(CUBE, TWELVE, "closest", (three, three), np.array([1.0, np.inf, 2.0]))
    assert case.wrong(np.array([1.000001, np.inf, 2.0])) == 0
    assert case.wrong(np.array([1.001, 5.0, np.inf])) == 3
    assert case.wrong(np.array([np.nan, np.nan, np.nan])) == 3
    assert Case(CUBE, TWELVE, "inside", (three,), np.array([True, False, True])).wrong(np.array([1, 1, 1])) == 1


# ---- The table


class Liar(Peer):
    """Says that nothing is ever hit, and fails at counting."""

    name = "liar"
    needs = ("no_such_module",)

    @classmethod
    def version(cls) -> str:
        return "1.2"

    def occlusion(self, origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
        return np.zeros(len(origins), np.bool_)

    def count(self, origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
        raise RuntimeError("no")


def test_the_table_tells_wrong_answers_by_project_and_version() -> None:
    those = [r for r in REPORTS if r.name in ("from_within_all_hit", "from_within_to_corners", "cavity")]
    lines = told([Kdray, Liar], those)
    assert "| liar 1.2 |" in lines[0]
    assert f"kdray {Kdray.version()}" in lines[0]
    n = len(those[0].make().right)
    assert lines[2:] == [
        f"| trimesh 1180, trimesh 263 | {n} occlusion | 0 | {n} |",
        f"| trimesh 1496 | {len(those[1].make().right)} count | 0 | RuntimeError |",
        f"| trimesh 2534 | {len(those[2].make().right)} inside | 0 | - |",
        "| cases with wrong answers | | 0 | 1 |",
    ]


def test_who_is_not_installed_is_left_out(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(command, "module", lambda name: None)
    assert main(["--reports"]) == 0
    out = capsys.readouterr().out
    assert "left out, as they can't be imported: trimesh+kdray, trimesh, trimesh+embreex, embreex, Open3D" in out
    assert f"| reported | asked | kdray {Kdray.version()} |" in out
    assert out.rstrip().endswith("| cases with wrong answers | | 0 |")


@pytest.mark.parametrize("peer", PEERS, ids=lambda peer: peer.name)
def test_peers_answer_plain_questions_as_is_right(peer: type[Peer]) -> None:
    for needed in peer.needs:
        pytest.importorskip(needed)
    assert peer.version()
    cube = peer(CUBE, TWELVE)
    random = np.random.default_rng(20261126)  # the seed
    origins = random.uniform(-3, 4, (100, 3)).astype(np.float32)
    directions = random.uniform(0.1, 0.9, (100, 3)) - origins
    directions = (directions / np.linalg.norm(directions, axis=1, keepdims=True)).astype(np.float32)
    right = Exact(CUBE, TWELVE)
    answers = {
        "closest": right.first(origins, directions),
        "occlusion": np.isfinite(right.first(origins, directions)),
        "count": right.crossings(origins, directions),
        "inside": right.inside(origins),
        "signed_distance": right.signed_distance(origins),
    }
    asked = 0
    for question, expected in answers.items():
        if hasattr(cube, question):
            given = (origins, directions) if question in ("closest", "occlusion", "count") else (origins,)
            # point-cloud-utils multiplies distances by an approximate winding number
            case = Case(CUBE, TWELVE, question, given, expected, tolerance=1e-2)
            assert case.wrong(getattr(cube, question)(*given)) == 0, question
            asked += 1
    assert asked >= 2
