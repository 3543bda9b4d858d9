"""Scenes in processes that are forked or spawned, in threads, and at the interpreter's end.

Each case is a script of its own, which a test ends, and fails, when it has not come to its end after a long while.
"""

import os
import pathlib
import signal
import subprocess
import sys

import pytest

import kdray

LIMIT = 300  # seconds: only what hangs takes as long

PRELUDE = """
import gc, multiprocessing, os, pickle, sys, threading
import numpy as np
import kdray

RAYS = ([[0, 0, 5.0]], [[0, 0, -1.0]])

def ball():
    scene = kdray.Scene()
    scene.add_spheres([[0, 0, 0]], 1)
    return scene

def ask(scene):
    return float(scene.closest_hit(*RAYS).t[0])

def error_of(call, *args):
    try:
        return f"answered {call(*args)}"
    except kdray.Error as error:
        return f"{type(error).__name__}: {error}"

def in_child(call, leave=os._exit):
    # 0 where call() has returned and the process could end.
    child = os.fork()
    if child == 0:
        status = 1
        try:
            call()
            status = 0
        finally:
            leave(status)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
"""


def run(folder: pathlib.Path, script: str) -> str:
    """What the script prints. It has to end well, and within the limit, with all that it has started."""
    file = folder / "script.py"
    file.write_text(PRELUDE + script)
    paths = [str(pathlib.Path(kdray.__file__).parents[1]), os.environ.get("PYTHONPATH", "")]
    made = subprocess.Popen(
        [sys.executable, str(file)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        out, err = made.communicate(timeout=LIMIT)
    except subprocess.TimeoutExpired:
        os.killpg(made.pid, signal.SIGKILL)
        out, err = made.communicate()
        pytest.fail(f"it hung; it had printed {out!r} and {err!r}")
    assert made.returncode == 0, err
    assert "terminate called" not in err and "Fatal" not in err and "Traceback" not in err, err
    return out


# ---- Forks


@pytest.mark.parametrize(
    "before", ["ask(scene)", "scene.commit()", "kdray.devices()", "ask(ball())", "kdray.Scene(device='0')"]
)
def test_a_fork_after_opencl_has_begun_is_told_so_at_once(tmp_path, before):
    out = run(
        tmp_path,
        f"""
scene = ball()
{before}
def child():
    for call in (
        lambda: ask(scene),
        lambda: scene.any_hit(*RAYS),
        lambda: scene.count_hits(*RAYS),
        lambda: scene.all_hits(*RAYS),
        lambda: scene.contains([0, 0, 0]),
        lambda: scene.closest_point([0, 0, 0]),
        lambda: scene.signed_distance([0, 0, 0]),
        lambda: scene.render(size=(4, 4)),
        lambda: ask(ball()),
        lambda: scene.copy().commit(),
        lambda: kdray.RaycastingScene().cast_rays([[0, 0, 5, 0, 0, -1]]),
        lambda: kdray.Scene(device="gpu"),
        lambda: kdray.devices(),
    ):
        told = error_of(call)
        assert told.startswith("NoDeviceError: this process was forked off") and "spawn" in told, told
        assert "\\n" not in told
    scene.add_spheres([[3, 0, 0]], 1)
    assert scene.primitives == 2
assert in_child(child) == 0
assert in_child(child, sys.exit) == 0
assert in_child(lambda: in_child(child)) == 0
print(ask(scene), len(scene.geometries))
""",
    )
    assert out.split()[0] == "4.0"


@pytest.mark.parametrize("leave", ["os._exit", "sys.exit"])
def test_what_a_fork_has_of_its_parents_can_be_freed(tmp_path, leave):
    run(
        tmp_path,
        f"""
scene, other = ball(), ball()
ask(scene), other.render(size=(8, 8))
def child():
    global scene, other
    del scene, other
    gc.collect()
assert in_child(child, {leave}) == 0
assert in_child(lambda: None, {leave}) == 0
assert ask(scene) == 4 and other.render(size=(8, 8)).shape == (8, 8, 3)
""",
    )


def test_a_fork_before_that_answers(tmp_path):
    out = run(
        tmp_path,
        """
scene = ball()
rng = np.random.default_rng(1)
scene.add_mesh(rng.normal(size=(300_000, 3)) + [9, 0, 0], rng.integers(0, 300_000, (100_000, 3)))
def child():
    print(ask(scene), flush=True)
assert in_child(child) == 0
assert in_child(child, sys.exit) == 0
print(ask(scene))
""",
    )
    assert out.split() == ["4.0"] * 3


def test_a_fork_beside_threads_that_ask(tmp_path):
    run(
        tmp_path,
        """
scene, over = ball(), threading.Event()
ask(scene)
many = np.broadcast_to([0, 0, 5.0], (100_000, 3))
def work():
    while not over.is_set():
        scene.closest_hit(many, [0, 0, -1.0])
        changed = ball()
        ask(changed)
threads = [threading.Thread(target=work) for _ in range(2)]
[t.start() for t in threads]
def child():
    assert error_of(ask, scene).startswith("NoDeviceError")
    assert error_of(ask, ball()).startswith("NoDeviceError")
for _ in range(20):
    assert in_child(child) == 0
over.set()
[t.join() for t in threads]
assert ask(scene) == 4
""",
    )


def test_a_page_stays_with_the_process_that_serves_it(tmp_path):
    if not hasattr(kdray._core, "Page"):
        pytest.skip("built without the page")
    run(
        tmp_path,
        """
view = ball().view()
def child():
    assert view.closed
    view.close()
    view.wait()
assert in_child(child) == 0
assert in_child(child, sys.exit) == 0
assert not view.closed
view.close()
assert view.closed
""",
    )


@pytest.mark.parametrize("way", ["spawn", "forkserver", "fork"])
def test_multiprocessing(tmp_path, way):
    out = run(
        tmp_path,
        f"""
from concurrent.futures import ProcessPoolExecutor

def work(scene, queue):
    queue.put(error_of(ask, scene))

def told(scene):
    return error_of(ask, scene)

if __name__ == "__main__":
    scene = ball()
    ask(scene)
    context = multiprocessing.get_context("{way}")
    queue = context.Queue()
    process = context.Process(target=work, args=(scene, queue))
    process.start()
    print(queue.get())
    process.join()
    assert process.exitcode == 0
    with context.Pool(2) as pool:
        for line in pool.map(told, [scene, scene, scene]):
            print(line)
        print(pool.apply_async(error_of, (ask, scene)).get())
    with ProcessPoolExecutor(2, mp_context=context) as executor:
        for line in executor.map(told, [scene, scene]):
            print(line)
        if "{way}" == "fork":
            print(error_of(executor.submit(ask, scene).result))
        else:
            print("answered", executor.submit(ask, scene).result())
""",
    )
    lines = out.splitlines()
    assert len(lines) == 8
    for line in lines:
        assert line.startswith("NoDeviceError: this process was forked" if way == "fork" else "answered 4.0"), line


def test_a_pool_that_is_forked_before_the_first_question(tmp_path):
    out = run(
        tmp_path,
        """
def told(scene):
    return error_of(ask, scene)

if __name__ == "__main__":
    scene = ball()
    with multiprocessing.get_context("fork").Pool(2) as pool:
        print(*pool.map(told, [scene, scene]))
        print(ask(scene))
        print(*pool.map(told, [scene, scene]))
""",
    )
    assert out.split() == ["answered", "4.0"] * 2 + ["4.0"] + ["answered", "4.0"] * 2


# ---- The interpreter's end


@pytest.mark.parametrize(
    "what",
    [
        "scene.closest_hit(many, [0, 0, -1.0])",
        "scene.all_hits(many, [0, 0, -1.0])",
        "ask(ball())",
        "scene.render(size=(64, 64))",
    ],
)
def test_daemon_threads_that_ask_while_the_interpreter_ends(tmp_path, what):
    for _ in range(5):
        out = run(
            tmp_path,
            f"""
scene = ball()
ask(scene)
many = np.broadcast_to([0, 0, 5.0], (200_000, 3))
begun = threading.Semaphore(0)
def work():
    while True:
        {what}
        begun.release()
for _ in range(3):
    threading.Thread(target=work, daemon=True).start()
for _ in range(3):
    begun.acquire()
print("over")
""",
        )
        assert out.split() == ["over"]


def test_what_the_main_thread_asks_at_its_end_is_answered(tmp_path):
    out = run(
        tmp_path,
        """
import atexit
scene = ball()
atexit.register(lambda: print(ask(scene)))
class AtLast:
    def __del__(self):
        print(ask(scene))
kept = AtLast()
thread = threading.Thread(target=lambda: print(ask(scene)))
thread.start()
""",
    )
    assert out.split() == ["4.0"] * 3


# ---- Devices


@pytest.mark.parametrize("device", ["cuda", "no such device", "99", 99])
def test_a_device_that_is_not_there_is_told_at_once(device, tmp_path):
    from_file = tmp_path / "empty.obj"
    from_file.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    for make in (kdray.Scene, kdray.RaycastingScene, lambda device: kdray.load(from_file, device=device)):
        with pytest.raises(kdray.NoDeviceError, match=f"called '{device}'"):
            make(device=device)


def test_devices_by_number_and_name():
    for device in kdray.devices():
        if device.usable:
            for wanted in (device.number, str(device.number), device.name):
                scene = kdray.Scene(device=wanted)
                assert not scene.any_hit([0, 0, 0], [0, 0, 1])


@pytest.mark.parametrize("way", ["copy.copy", "copy.deepcopy", "lambda s: pickle.loads(pickle.dumps(s))"])
def test_copies_of_a_scene_that_was_asked_are_scenes_of_their_own(tmp_path, way):
    out = run(
        tmp_path,
        f"""
import copy
scene = ball()
before = ask(scene)
other = ({way})(scene)
other.add_spheres([[0, 0, 2]], 1)
print(before, ask(scene), ask(other), len(scene.geometries), len(other.geometries))
""",
    )
    assert out.split() == ["4.0", "4.0", "2.0", "1", "2"]
