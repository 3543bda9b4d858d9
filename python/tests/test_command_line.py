"""The package's commands, and that its hits are the command line's."""

import subprocess
import sys

import numpy as np
import pytest

import kdray


def run(*words, **named):
    return subprocess.run([sys.executable, "-m", "kdray", *words], capture_output=True, text=True, **named)


def test_the_doctor_traces_a_ray():
    done = run("doctor")
    assert done.returncode == 0, done.stderr
    assert "a ray was traced: t = 4" in done.stdout


def test_other_words_go_to_the_command_line(tmp_path):
    done = run("generate", "tetra", "--size", "2", "-o", str(tmp_path / "t.nff"))
    assert done.returncode == 0 and (tmp_path / "t.nff").exists()
    assert run("no-such-command").returncode == 2


@pytest.mark.parametrize("scene", ["tetra", "balls", "gears"])
def test_hits_are_the_command_lines_bit_for_bit(tmp_path, rng, scene):
    file = tmp_path / f"{scene}.nff"
    assert run("generate", scene, "--size", "2", "-o", str(file)).returncode == 0
    loaded = kdray.load(file)
    o = rng.normal(size=(5000, 3)).astype(np.float32) * 4
    d = (rng.normal(size=(5000, 3)) - o / 4).astype(np.float32)
    rays = np.concatenate([o, np.zeros((5000, 1)), d, np.full((5000, 1), np.inf)], axis=1).astype(np.float32)
    np.save(tmp_path / "rays.npy", rays)
    done = run("trace", str(file), "--rays", str(tmp_path / "rays.npy"), "-o", str(tmp_path / "hits.npy"))
    assert done.returncode == 0, done.stderr
    expected = np.load(tmp_path / "hits.npy")
    hits = loaded.closest_hit(o, d)
    assert hits.hit.any()
    for name in ("t", "primitive", "u", "v"):
        np.testing.assert_array_equal(getattr(hits, name), expected[name], err_msg=name)


def test_the_extras_driver_serves_where_the_system_has_none(tmp_path):
    pytest.importorskip("kdray_pocl", reason="the extra kdray[pocl] is not installed")
    import os

    empty = tmp_path / "vendors"
    empty.mkdir()
    environment = {**os.environ, "OPENCL_VENDOR_PATH": str(empty), "KDRAY_CACHE_DIR": str(tmp_path / "cache")}
    done = run("doctor", env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "PoCL of the extra" in done.stdout and "a ray was traced" in done.stdout
