"""trimesh's own tests of rays, from its source distribution, with kdray as its engine."""

import os
import pathlib
import subprocess
import sys
import tarfile
import tempfile

import pytest

import kdray

trimesh = pytest.importorskip("trimesh")

TESTS = ("test_ray.py", "test_ray_upstream.py")

# They need files of trimesh's repository that its distribution lacks (models/ and tests/data/).
WITHOUT_MODELS = {
    "test_ray.py::test_rays": "ray_data.json and its models",
    "test_ray.py::test_contain_single": "teapot.stl",
    "test_ray_upstream.py::test_issue_1362_many_rays_consistency": "featuretype.STL",
}

# In place of tests/generic.py, which the distribution lacks as well. Models of which the name says all are made here.
GENERIC = '''
import importlib.util
import logging
import time

import numpy as np
import trimesh

log = logging.getLogger("trimesh")
random = np.random.default_rng(0).random

if importlib.util.find_spec("manifold3d") is None:  # a box within a box is all that is asked for
    trimesh.boolean.difference = lambda boxes: trimesh.util.concatenate(boxes[0], boxes[1].invert() or boxes[1])


def seven_eighths():
    """A cube without one of its octants: cells of a grid, and their faces towards what is outside."""
    grid = trimesh.voxel.VoxelGrid(np.array([[[True, True], [True, True]], [[True, True], [True, False]]]))
    corners, faces = {}, []
    filled = {tuple(cell) for cell in np.argwhere(grid.matrix)}
    for cell in sorted(filled):
        for axis in range(3):
            for side in (0, 1):
                beside = list(cell)
                beside[axis] += 2 * side - 1
                if tuple(beside) in filled:
                    continue
                quad = []
                for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    corner = list(cell)
                    corner[axis] += side
                    corner[(axis + 1) % 3] += a
                    corner[(axis + 2) % 3] += b
                    quad.append(corners.setdefault(tuple(corner), len(corners)))
                quad = quad if side else quad[::-1]
                faces += [quad[:3], [quad[0], quad[2], quad[3]]]
    mesh = trimesh.Trimesh((np.array(list(corners), float) - 1) * 10, faces, process=False)
    assert mesh.is_watertight and mesh.volume == 7000
    return mesh


def get_mesh(name, use_embree=True):
    made = {
        "unit_cube.STL": trimesh.creation.box,
        "unit_sphere.STL": trimesh.creation.icosphere,
        "7_8ths_cube.stl": seven_eighths,
    }[name]()
    return trimesh.Trimesh(made.vertices, made.faces, use_embree=use_embree)
'''

# Loaded by pytest before the tests: all engines that they name are kdray's.
PLUGIN = """
import sys
import types

import kdray.trimesh
import trimesh

kdray.trimesh.install()
Engine = kdray.trimesh.RayMeshIntersector
assert trimesh.ray.has_embree
assert trimesh.ray.ray_pyembree.RayMeshIntersector is trimesh.ray.ray_triangle.RayMeshIntersector is Engine
assert all(type(trimesh.creation.box(use_embree=embree).ray) is Engine for embree in (False, True))
sys.modules["embreex"] = types.ModuleType("embreex")  # a test asks for its version, and goes on from 4
sys.modules["embreex"].__version__ = "4.4.0"

asked = 0
scene = Engine.scene.fget


def counted(self):
    global asked
    asked += 1
    return scene(self)


Engine.scene = property(counted)


def pytest_terminal_summary(terminalreporter):
    terminalreporter.write_line(f"kdray was asked {asked} times")
"""


def fetched() -> pathlib.Path:
    """The tests' folder in the distribution of trimesh's installed version; fetched once."""
    version = trimesh.__version__
    build = pathlib.Path(__file__).resolve().parents[2] / "build"
    keep = build / "python" if os.access(build, os.W_OK) else pathlib.Path(tempfile.gettempdir()) / "kdray-tests"
    folder = keep / f"trimesh-{version}"
    if not folder.exists():
        keep.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=keep) as scratch:
            command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--no-binary", "trimesh"]
            command += ["--disable-pip-version-check", "--timeout", "10", "--retries", "0", "--dest", scratch]
            done = subprocess.run([*command, f"trimesh=={version}"], capture_output=True, text=True)
            if done.returncode:
                pytest.skip(f"trimesh's source distribution can't be fetched from PyPI: {done.stderr.strip()[-200:]}")
            with tarfile.open(next(pathlib.Path(scratch).glob("trimesh-*.tar.gz"))) as packed:
                packed.extractall(scratch, filter="data")
            os.rename(pathlib.Path(scratch) / f"trimesh-{version}" / "tests", folder)
    return folder


def test_its_own_tests_of_rays_pass(tmp_path):
    tests = fetched()
    for name, text in (("generic.py", GENERIC), ("kdray_as_engine.py", PLUGIN)):
        (tmp_path / name).write_text(text)
    for name in TESTS:
        (tmp_path / name).write_bytes((tests / name).read_bytes())
    command = [sys.executable, "-m", "pytest", "-v", "-p", "kdray_as_engine", "-p", "no:cacheprovider", "--rootdir"]
    command += [str(tmp_path), *(f"--deselect={name}" for name in WITHOUT_MODELS), *TESTS]
    package = str(pathlib.Path(kdray.__file__).parents[1])
    path = os.pathsep.join([str(tmp_path), package, os.environ.get("PYTHONPATH", "")])
    env = os.environ | {"PYTHONPATH": path, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PYTEST_ADDOPTS": ""}
    done = subprocess.run(command, cwd=tmp_path, env=env, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    assert "kdray was asked" in done.stdout and "kdray was asked 0 times" not in done.stdout
    assert f"{len(WITHOUT_MODELS)} deselected" in done.stdout, done.stdout[-2000:]  # they are still called so
    assert "skipped" not in done.stdout.splitlines()[-1], done.stdout[-2000:]
