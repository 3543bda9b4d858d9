"""What scenes are made of: changes, copies, errors, threads."""

import copy
import gc
import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import kdray

DOWN = ([[0.1, 0.2, 5.0]], [0, 0, -1])


def test_every_kind_of_shape():
    scene = kdray.Scene()
    ids = [
        scene.add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], name="triangle"),
        scene.add_spheres([[0, 0, -4]], 1),
        scene.add_cones([0.1, 0, -8], 1, [0.1, 9, -8], 1),
        scene.add_discs([0, 0, -12], [0, 0, 1], 1),
        scene.add_tori([1, 0, -20], [0, 0, 1], 1, 0.5),
    ]
    hits = scene.all_hits(*DOWN)
    assert ids == [0, 1, 2, 3, 4] and hits.geometry.tolist() == [0, 1, 1, 2, 2, 3, 4, 4]
    assert scene.primitives == 5 and [g.name for g in scene.geometries] == ["triangle", "", "", "", ""]


def test_tori_have_an_outside_and_a_hole():
    scene = kdray.Scene()
    rings = scene.add_tori([[0, 0, 0], [9, 0, 0]], [[0, 0, 2]] * 2, 2, [0.5, 0.25], name="rings")
    assert scene.info(rings).primitives == 2
    assert scene.count_hits([[20, 0, 0], [0, 0, 5]], [[-1, 0, 0], [0, 0, -1]]).tolist() == [8, 0]
    hit = scene.closest_hit([0, 2.3, 5], [0, 0, -1])
    np.testing.assert_allclose([hit.t, *hit.normal.ravel()], [4.6, 0, 0.6, 0.8], atol=1e-5)
    copied = pickle.loads(pickle.dumps(scene))
    np.testing.assert_array_equal(copied.closest_hit([0, 2.3, 5], [0, 0, -1]).t, hit.t)
    for major, minor, message in [(1, 1, "less than its major_radius"), (5000, 1, "at most 4096"), (1, 0, "above 0")]:
        with pytest.raises(kdray.InputError, match=rf"tori\[0\].*{message}"):
            scene.add_tori([0, 0, 0], [0, 0, 1], major, minor)
    assert [g.id for g in scene.geometries] == [rings]


def test_shapes_of_any_kind_by_the_names_of_their_fields():
    named, by_kind = kdray.Scene(), kdray.Scene()
    named.add_cones([[0, 0, 0], [9, 0, 0]], 2, [[0, 0, 4], [9, 0, 4]], 0, mask=3)
    cones = {"apexes": [[0, 0, 4], [9, 0, 4]], "bases": [[0, 0, 0], [9, 0, 0]], "base_radii": 2}  # and pointed
    by_kind.add_shapes("cones", **cones, mask=3, name="tents")
    rays = ([[1, 0.25, 9], [9.5, 0.25, 9], [20, 0, 9]], [0, 0, -1])
    wanted = named.closest_hit(*rays)
    for scene in (by_kind, pickle.loads(pickle.dumps(by_kind))):
        np.testing.assert_array_equal(scene.closest_hit(*rays).t, wanted.t)
        assert scene.info(0).name == "tents" and scene.info(0).mask == 3
    assert wanted.hit.tolist() == [True, True, False]
    for kind, arrays, message in [
        ("cubes", {}, 'no shapes "cubes", but spheres, cones, discs, tori'),
        ("cones", cones | {"radii": 1}, "cones have no radii, but bases"),
        ("spheres", {"centers": [0, 0, 0]}, "spheres need radii"),
    ]:
        with pytest.raises(kdray.UsageError, match=message):
            by_kind.add_shapes(kind, **arrays)


@pytest.mark.parametrize("dtype", [np.int32, np.uint32, np.int64, np.uint64, np.int16, np.uint8])
def test_indices_of_any_type(dtype):
    scene = kdray.Scene()
    scene.add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.array([[0, 1, 2]], dtype))
    assert scene.any_hit(*DOWN).all()


@pytest.mark.parametrize(
    ("vertices", "triangles", "message"),
    [
        ([[0, 0, 0]] * 3, [[0, 1, 3]], r"triangles\[0\].*out of range"),
        ([[0, 0, 0]] * 3, [[0, 1, -1]], r"triangles\[0\].*out of range"),
        ([[0, 0, 0], [0, 0, np.nan], [0, 0, 0]], [[0, 1, 2]], r"vertices\[1\]: not finite"),
        ([[0, 0, 0]] * 3, [[0.0, 1.0, 2.0]], "indices are whole numbers"),
        ([[0, 0, 0]] * 3, [0, 1, 2], r"triangles: the shape is to be \(n, 3\)"),
        ([0, 1], [[0, 1, 2]], "vertices: the shape"),
    ],
)
def test_wrong_meshes_are_refused_and_change_nothing(vertices, triangles, message):
    scene = kdray.Scene()
    with pytest.raises(kdray.InputError, match=message):
        scene.add_mesh(vertices, triangles)
    assert scene.geometries == [] and not scene.any_hit(*DOWN).any()
    with pytest.raises(ValueError, match="radius above 0"):
        scene.add_spheres([0, 0, 0], -1)


def test_changes_show_in_the_next_question(ball_mesh):
    vertices, triangles = ball_mesh
    scene = kdray.Scene()
    ball = scene.add_mesh(vertices, triangles)
    other = scene.add_spheres([0, 0, -9], 1)
    assert scene.closest_hit(*DOWN).geometry == [ball]
    scene.update_vertices(ball, vertices + [0, 0, 1.0])
    before = scene.closest_hit([0, 0, 5], [0, 0, -1])
    assert before.t == 3
    scene.enable(ball, False)
    assert scene.closest_hit(*DOWN).geometry == [other]
    scene.enable(ball)
    assert scene.closest_hit([0, 0, 5], [0, 0, -1]).t == before.t
    scene.remove(ball)
    assert scene.closest_hit(*DOWN).geometry == [other]
    with pytest.raises(kdray.UsageError, match="there is no geometry"):
        scene.info(ball)
    assert scene.add_spheres([0, 0, 0], 1) == 2


def copies_of(scene):
    return [scene.copy(), copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))]


def test_copies_are_the_same_and_apart(ball_mesh):
    scene = kdray.Scene(compute_units=1)
    red = scene.add_material(kdray.Material(diffuse=(1, 0, 0)))
    scene.add_light(kdray.Light(position=(5, 5, 5)))
    scene.set_background((0, 0, 1))
    gone = scene.add_spheres([0, 0, 2], 1)
    kept = scene.add_mesh(*ball_mesh, name="ball", mask=3, material=red)
    hidden = scene.add_spheres([0, 0, 3], 1)
    scene.remove(gone)
    scene.enable(hidden, False)
    camera = kdray.Camera((0, 0, 5))
    picture = scene.render(camera, (16, 16))
    for made in copies_of(scene):
        assert made.geometries == scene.geometries
        assert made.closest_hit(*DOWN).geometry == [kept]
        np.testing.assert_array_equal(made.render(camera, (16, 16)), picture)
        made.remove(kept)
        made.enable(hidden)
        assert made.closest_hit(*DOWN).geometry == [hidden]
        assert made.add_spheres([0, 0, 0], 1) == 3
    assert scene.closest_hit(*DOWN).geometry == [kept]


def write_triangle(path):
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    return path


def test_files_are_geometry_0_and_are_copied_by_name(tmp_path):
    scene = kdray.load(write_triangle(tmp_path / "a.obj"))
    ball = scene.add_spheres([0, 0, -4], 1)
    assert ball == 1 and scene.all_hits(*DOWN).geometry.tolist() == [0, 1, 1]
    for made in copies_of(scene):
        assert made.all_hits(*DOWN).geometry.tolist() == [0, 1, 1]
    scene.remove(0)
    for made in [scene, *copies_of(scene)]:
        assert made.all_hits(*DOWN).geometry.tolist() == [1, 1]


def test_hits_are_told_by_the_names_that_the_file_gives(tmp_path):
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 3 0 0\nv 4 0 0\nv 3 1 0\nv 6 0 0\nv 7 0 0\nv 6 1 0\n"
    faces = "f 7 8 9\no left\nusemtl brass\nf 1 2 3\no right\nusemtl tin\nf 4 5 6\n"
    (tmp_path / "a.obj").write_text(corners + faces)
    scene = kdray.load(tmp_path / "a.obj")
    (file,) = scene.geometries
    assert file.parts == (kdray.Part("left", 1, 1), kdray.Part("right", 2, 1)) and file.instance_parts == ()
    assert [m.name for m in scene.materials] == ["", "brass", "tin"] and [m.primitives for m in scene.materials] == [
        1
    ] * 3

    red = scene.add_material(kdray.Material(diffuse=(1, 0, 0)))
    scene.add_spheres([9, 0, 0], 1, name="ball", material=red)
    hits = scene.closest_hit([[[0.2, 0.2, 5], [3.2, 0.2, 5]], [[6.2, 0.2, 5], [9, 0, 5]], [[50, 0, 5]] * 2], [0, 0, -1])
    names = scene.names_of(hits)
    assert names.tolist() == [["left", "right"], [file.name, "ball"], ["", ""]]
    materials = scene.materials_of(hits)
    assert [scene.materials[m].name for m in materials.ravel()[:3]] == ["brass", "tin", ""]
    assert materials[1, 1] == 3 + red and scene.materials[3 + red].primitives == 1 and (materials[2] == -1).all()
    crossed = scene.all_hits([[0.2, 0.2, 5], [9, 0, 5]], [0, 0, -1])
    assert scene.names_of(crossed).tolist() == ["left", "ball", "ball"]
    assert scene.materials_of(crossed).tolist() == [1, 3 + red, 3 + red]
    assert scene.names_of(scene.closest_hit([0.2, 0.2, 5], [0, 0, -1])) == "left" and names.dtype == object
    assert pickle.loads(pickle.dumps(scene)).names_of(hits).tolist() == names.tolist()


def test_files_may_name_what_is_below_the_asset_root(tmp_path):
    for folder in ("scenes", "parts"):
        (tmp_path / folder).mkdir()
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
    (tmp_path / "parts" / "a.bin").write_bytes(corners.tobytes())
    gltf = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "../parts/a.bin"}],
    }
    file = tmp_path / "scenes" / "a.gltf"
    file.write_text(json.dumps(gltf))
    with pytest.raises(kdray.InputError, match="is not a file beside the scene, or below"):
        kdray.load(file)
    scene = kdray.load(file, asset_root=tmp_path / "parts")
    assert scene.primitives == 1
    assert pickle.loads(pickle.dumps(scene)).primitives == 1
    with pytest.raises(kdray.UsageError, match="is no folder"):
        kdray.load(file, asset_root=tmp_path / "nothing")


def test_files_that_are_wrong(tmp_path):
    with pytest.raises(kdray.InputError, match="nothing"):
        kdray.load(tmp_path / "nothing.obj")
    bad = tmp_path / "bad.obj"
    bad.write_text("v 0 0 zero\n")
    with pytest.raises(kdray.InputError, match=r"bad\.obj:1"):
        kdray.load(bad)


def test_a_quality_that_is_not_there_changes_nothing(ball_mesh):
    scene = kdray.Scene()
    scene.add_mesh(*ball_mesh)
    with pytest.raises(kdray.UsageError, match='not "worst"'):
        scene.commit("worst")
    assert scene.any_hit([0, 0, 5], [0, 0, -1])


def test_copies_give_no_id_again(ball_mesh):
    scene = kdray.Scene()
    scene.add_mesh(*ball_mesh)
    scene.remove(scene.add_spheres([[0, 0, 0]], 1))
    for other in (scene.copy(), pickle.loads(pickle.dumps(scene))):
        assert other.add_spheres([[0, 0, 0]], 1) == 2


def test_names_of_what_was_removed_are_none(ball_mesh):
    scene = kdray.Scene()
    mesh = scene.add_mesh(*ball_mesh, name="ball")
    hits = scene.closest_hit([[0, 0, 5]], [[0, 0, -1]])
    scene.remove(mesh)
    assert scene.names_of(hits).tolist() == [""]


def test_instances_of_a_file_may_be_copied(tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "a.json").write_text(
        json.dumps({"objects": [{"type": "mesh", "file": "a.obj", "translate": [k, 0, 0]} for k in range(3)]})
    )
    assert kdray.load(tmp_path / "a.json", instances="flat").primitives == 3
    with pytest.raises(kdray.UsageError, match='not "keep"'):
        kdray.load(tmp_path / "a.json", instances="keep")


def test_a_quality_that_is_not_there():
    with pytest.raises(kdray.UsageError, match="quality"):
        kdray.Scene().commit("perfect")


def test_devices_tell_what_they_are():
    assert any(device.usable and device.compute_units > 0 for device in kdray.devices())


def test_threads_ask_while_another_changes(ball_mesh):
    vertices, triangles = ball_mesh
    scene = kdray.Scene()
    id = scene.add_mesh(vertices, triangles)
    scene.commit()
    stop, wrong = threading.Event(), []

    def ask():
        while not stop.is_set():
            t = scene.closest_hit(np.zeros((100, 3)) + [0, 0, 9], [0, 0, -1]).t
            if not np.isin(t, [8.0, 7.0]).all() or len(set(t.tolist())) != 1:
                wrong.append(t)

    threads = [threading.Thread(target=ask) for _ in range(2)]
    for thread in threads:
        thread.start()
    for round in range(20):
        scene.update_vertices(id, vertices + [0, 0, round % 2])
        scene.commit()
    stop.set()
    for thread in threads:
        thread.join()
    assert wrong == []


def resident_kib():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * (os.sysconf("SC_PAGE_SIZE") // 1024)


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="no /proc to read memory from")
def test_a_thousand_scenes_leave_no_memory_behind(ball_mesh):
    vertices, triangles = ball_mesh
    scenes = int(os.environ.get("KDRAY_STRESS_SCENES", "200"))

    def one(round):
        scene = kdray.Scene()
        id = scene.add_mesh(vertices, triangles)
        scene.any_hit(*DOWN)
        scene.update_vertices(id, vertices * (1 + round % 7))
        threads = [threading.Thread(target=lambda: scene.closest_hit(*DOWN)) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    for round in range(scenes // 4):
        one(round)
    gc.collect()
    before = resident_kib()
    for round in range(scenes):
        one(round)
    gc.collect()
    assert resident_kib() - before < 24 * 1024  # a scene of these takes 0.3 MiB


LONG = """
import numpy as np, kdray
rng = np.random.default_rng(1)
scene = kdray.Scene()
scene.add_spheres(rng.normal(size=(20000, 3)), 0.02)
scene.commit()
o, d = rng.normal(size=(2, 1 << 21, 3)).astype(np.float32)
print("asking", flush=True)
while True:
    scene.{question}
"""


@pytest.mark.parametrize("question", ["closest_hit(o, d)", "count_hits(o, d)", "render(size=(4096, 4096), samples=64)"])
def test_ctrl_c_ends_a_long_call(question):
    program = subprocess.Popen(
        [sys.executable, "-c", LONG.format(question=question)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert program.stdout.readline() == "asking\n"
    time.sleep(1)
    program.send_signal(signal.SIGINT)
    _, errors = program.communicate(timeout=600)
    assert "KeyboardInterrupt" in errors and program.returncode != 0


# A ray hits a thousand of these triangles.
SOUP = LONG.replace(
    "scene.add_spheres(rng.normal(size=(20000, 3)), 0.02)",
    """
scene.add_mesh(rng.uniform(-1, 1, (90000, 3)), np.arange(90000).reshape(-1, 3))
""",
)


def test_ctrl_c_ends_a_call_of_very_many_hits():
    program = subprocess.Popen(
        [sys.executable, "-c", SOUP.format(question="all_hits(0.1 * o[:40000], d[:40000], max_hits=300)")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert program.stdout.readline() == "asking\n"
    time.sleep(1)
    program.send_signal(signal.SIGINT)
    _, errors = program.communicate(timeout=60)
    assert "KeyboardInterrupt" in errors and program.returncode != 0


def test_bounds_are_of_what_is_there(ball_mesh):
    vertices, triangles = ball_mesh
    scene = kdray.Scene()
    assert scene.bounds is None
    scene.add_mesh(vertices + [5e5, 0, 0], triangles)
    np.testing.assert_allclose(scene.bounds, [[5e5 - 1, -1, -1], [5e5 + 1, 1, 1]], atol=3e-7)
