"""Instances: what they answer, what is refused, and that they can be moved, copied and pickled."""

import base64
import copy
import json
import pathlib
import pickle

import numpy as np
import pytest

import kdray

Mesh = tuple[np.ndarray, np.ndarray]


def places(n: int, rng: np.random.Generator) -> np.ndarray:
    """Balls of half to one in size on a line, ten apart, turned about z."""
    angle, size = rng.uniform(0, 6, n), rng.uniform(0.5, 1, n)
    m = np.zeros((n, 3, 4))
    m[:, 0, 0] = m[:, 1, 1] = size * np.cos(angle)
    m[:, 0, 1], m[:, 1, 0] = -size * np.sin(angle), size * np.sin(angle)
    m[:, 2, 2] = size
    m[:, 0, 3] = 10 * np.arange(n)
    return m


def down(n: int, z: float = 9) -> np.ndarray:
    return np.stack([10.0 * np.arange(n), np.full(n, 0.01), np.full(n, z)], axis=-1)


def test_hits_tell_the_instance(ball_mesh: Mesh, rng: np.random.Generator) -> None:
    scene = kdray.Scene()
    ball = scene.add_mesh(*ball_mesh, prototype=True)
    m = places(20, rng)
    balls = scene.add_instances(ball, m)
    hits = scene.closest_hit(down(21), [0, 0, -1])
    assert (hits.geometry == [balls] * 20 + [-1]).all()
    assert (hits.instance == [*range(20), -1]).all()
    assert np.allclose(hits.t[:20], 9 - m[:, 2, 2], atol=0.02)
    assert (hits.primitive[:20] >= 0).all()
    assert scene.any_hit(down(21), [0, 0, -1]).tolist() == [True] * 20 + [False]
    info = scene.info(balls)
    assert info.instances == 20 and info.primitives == len(ball_mesh[1]) and scene.info(ball).prototype


def test_scenes_without_instances_have_no_such_field(ball: kdray.Scene) -> None:
    assert "instance" not in ball.closest_hit([0, 0, 9], [0, 0, -1]).fields
    assert ball.closest_hit([0, 0, 9], [0, 0, -1], fields=("instance",)).instance == -1


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_every_layout_of_transforms(ball_mesh: Mesh, rng: np.random.Generator, dtype: type) -> None:
    m = places(7, rng).astype(dtype)
    square = np.zeros((7, 4, 4), dtype)
    square[:, :3], square[:, 3, 3] = m, 1
    expected = None
    for given in (m, square, m.reshape(7, 12), np.asfortranarray(m), square[::-1][::-1], m.tolist()):
        scene = kdray.Scene()
        scene.add_instances(scene.add_mesh(*ball_mesh, prototype=True), given)
        t = scene.closest_hit(down(7), [0, 0, -1]).t
        expected = t if expected is None or given is m else expected
        assert np.allclose(t, expected, atol=1e-5)
    one = kdray.Scene()
    one.add_instances(one.add_mesh(*ball_mesh, prototype=True), np.eye(4))
    assert one.closest_hit([0, 0, 9], [0, 0, -1]).instance == 0


def test_moved_masked_and_copied(ball_mesh: Mesh, rng: np.random.Generator) -> None:
    scene = kdray.Scene()
    ball = scene.add_mesh(*ball_mesh, prototype=True)
    red = scene.add_material(kdray.Material(diffuse=(1, 0, 0)))
    m = places(5, rng)
    balls = scene.add_instances(ball, m, materials=[red, -1, -1, red, -1], mask=2, name="balls")
    assert scene.any_hit(down(5), [0, 0, -1], mask=1).sum() == 0
    before = scene.closest_hit(down(5), [0, 0, -1]).t
    m[:, 2, 3] = 1
    scene.update_transforms(balls, m)
    after = scene.closest_hit(down(5), [0, 0, -1]).t
    assert np.allclose(after, before - 1, atol=1e-5)
    for other in (copy.copy(scene), pickle.loads(pickle.dumps(scene))):
        hits = other.closest_hit(down(5), [0, 0, -1])
        assert (hits.t == after).all() and (hits.geometry == balls).all()
        assert other.info(balls).name == "balls" and other.info(balls).mask == 2


def test_what_is_refused(ball_mesh: Mesh) -> None:
    scene = kdray.Scene()
    plain, ball = scene.add_mesh(*ball_mesh), scene.add_mesh(*ball_mesh, prototype=True)
    here = np.eye(4)[:3]
    with pytest.raises(kdray.InputError, match=r"\(n, 3, 4\)"):
        scene.add_instances(ball, np.zeros((3, 3)))
    with pytest.raises(kdray.InputError, match=r"transforms\[1\]: the last row"):
        scene.add_instances(ball, np.array([np.eye(4), np.ones((4, 4))]))
    with pytest.raises(kdray.InputError, match=r"transforms\[1\]: .*flattens"):
        scene.add_instances(ball, np.array([here, 0 * here]))
    with pytest.raises(kdray.UsageError, match="no prototype"):
        scene.add_instances(plain, here)
    some = scene.add_instances(ball, here)
    with pytest.raises(kdray.UsageError, match="instances itself"):
        scene.add_instances(some, here)
    with pytest.raises(kdray.UsageError, match="has instances"):
        scene.remove(ball)
    with pytest.raises(kdray.UsageError, match="closest points"):
        scene.closest_point([0, 0, 0])


def test_pictures_are_those_of_copies(ball_mesh: Mesh, rng: np.random.Generator) -> None:
    vertices, triangles = ball_mesh
    m = places(4, rng)
    camera = kdray.Camera((15, -40, 15), (15, 0, 0), (0, 0, 1))
    scene, flat = kdray.Scene(), kdray.Scene()
    scene.add_instances(scene.add_mesh(*ball_mesh, prototype=True), m)
    for place in m:
        flat.add_mesh(vertices @ place[:, :3].T + place[:, 3], triangles)
    kept, copied = (np.asarray(s.render(camera, (120, 60), look="plain")) for s in (scene, flat))
    assert np.mean(np.abs(kept - copied) > 0.01) < 0.01


def test_hits_in_a_files_instances_have_their_nodes_names(tmp_path: pathlib.Path) -> None:
    """A glTF file with so many nodes of a mesh that it is held once."""
    n, n_nodes = 2_000, 600
    corners = np.tile(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32), (n, 1))
    corners[:, 2] = -np.repeat(np.arange(n), 3) / n
    uri = "data:application/octet-stream;base64," + base64.b64encode(corners.tobytes()).decode()
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(n_nodes))}],
        "nodes": [{"mesh": 0, "name": f"tree {i}", "translation": [5 * i, 0, 0]} for i in range(n_nodes)],
        "materials": [{"name": "bark"}, {"name": "unused"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "buffers": [{"byteLength": corners.nbytes, "uri": uri}],
        "bufferViews": [{"buffer": 0, "byteLength": corners.nbytes}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3 * n}],
    }
    (tmp_path / "a.gltf").write_text(json.dumps(document))
    scene = kdray.load(tmp_path / "a.gltf")
    (file,) = scene.geometries
    assert [(p.name, p.first, p.count) for p in file.instance_parts] == [(f"tree {i}", i, 1) for i in range(n_nodes)]
    hits = scene.closest_hit([[10.2, 0.2, 5], [0.2, 0.2, 5], [3, 0.2, 5]], [0, 0, -1])
    assert scene.names_of(hits).tolist() == ["tree 2", "tree 0", ""]
    materials = scene.materials_of(hits)
    assert [scene.materials[m].name for m in materials[:2]] == ["bark", "bark"] and materials[2] == -1
