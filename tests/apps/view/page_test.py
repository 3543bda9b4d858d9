#!/usr/bin/env python3
"""`kdray view`'s page as a user has it: in a headless Chromium, from the printed address.

    page_test.py KDRAY SCENE [OTHER SCENE]

Its pictures at rest are compared, byte for byte, with those that the page's own command renders; mouse and keys, picks,
channels, reload, resizing, and how the program ends, follow. Skips (status 77) where there is no Chromium.
"""

import hashlib
import math
import os
import pathlib
import shutil
import signal
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from browser import Browser  # noqa: E402
from viewer import Viewer, camera, choose, compare, distance, near, png, resize, rest  # noqa: E402

WIDTH, HEIGHT = 640, 480
MIDDLE = (WIDTH / 2, HEIGHT / 2)
SHIFT = 8

if not Browser.find():
    print("skipped: there is no chromium here (Debian: chromium)")
    sys.exit(77)
kdray = os.path.abspath(sys.argv[1])


def check_picture(browser, folder, name):
    return hashlib.sha256(compare(kdray, browser, folder, name)).hexdigest()


def mouse_and_keys(b, folder):
    seen = {check_picture(b, folder, "as it opens")}
    start = camera(b)

    b.drag(MIDDLE, (MIDDLE[0] + 90, MIDDLE[1] + 25))
    now = camera(b)
    assert near(now["at"], start["at"]) and now["from"] != start["from"], "a drag orbits"
    assert math.isclose(distance(now), distance(start), rel_tol=1e-5)
    seen.add(check_picture(b, folder, "orbit"))

    before = camera(b)
    b.drag(MIDDLE, (MIDDLE[0] - 60, MIDDLE[1] + 40), modifiers=SHIFT)
    now = camera(b)
    moves = [[q - p for p, q in zip(before[k], now[k])] for k in ("from", "at")]
    assert math.dist(*moves) < 1e-5 * distance(now) and math.hypot(*moves[0]) > 0, "shift-drag pans"
    seen.add(check_picture(b, folder, "pan"))

    before = camera(b)
    b.wheel(WIDTH * 0.3, HEIGHT * 0.4, -240)
    b.wait("kdray.state.moving || kdray.state.final")
    seen.add(check_picture(b, folder, "zoom"))
    assert distance(camera(b)) < 0.9 * distance(before), "the wheel zooms"

    before = camera(b)
    gone = "Math.hypot(...kdray.state.camera.from.map((x, k) => x - " + str(before["from"]) + "[k]))"
    b.key("KeyS", "s", until=f"{gone} > {0.02 * distance(before)}")
    seen.add(check_picture(b, folder, "fly"))
    assert math.dist(camera(b)["from"], before["from"]) > 0.02 * distance(before), "S flies back"

    for code, text, what in (("Digit1", "1", "front"), ("Digit3", "3", "side"), ("Digit7", "7", "top"),
                             ("KeyU", "u", "up"), ("KeyO", "o", "parallel rays")):  # fmt: skip
        b.key(code, text)
        seen.add(check_picture(b, folder, what))
    assert camera(b)["ortho"] > 0 and camera(b)["up"] != start["up"]
    b.key("KeyR", "r")
    b.key("KeyF", "f")
    seen.add(check_picture(b, folder, "all of it"))
    b.key("KeyR", "r")
    rest(b)
    assert camera(b) == start, "R goes back"
    assert len(seen) == 11, f"some of these are the same picture: {len(seen)}"


def picks(b):
    b.click(*MIDDLE)
    b.wait("!document.getElementById('picked').hidden")
    told = dict(b.ask(
        "[...document.querySelectorAll('#picked dt')].map(dt => [dt.textContent, dt.nextSibling.textContent])"
    ))  # fmt: skip
    c = camera(b)
    point = [float(x) for x in told["point"].split(", ")]
    assert math.isclose(math.dist(point, c["from"]), float(told["distance"]), rel_tol=1e-4), told
    # The middle of the picture looks along the view.
    ahead = [(p - q) / distance(c) for p, q in zip(c["at"], c["from"])]
    along = sum(a * (p - q) for a, p, q in zip(ahead, point, c["from"]))
    assert math.isclose(along, float(told["distance"]), rel_tol=1e-3), "it lies in the middle"
    assert "material" in told and "geometry" in told, told
    print(f"ok  pick: {b.ask('document.querySelector(`#picked h2`).textContent')}, {told}")
    b.key("Escape", "Escape")
    x, y = WIDTH * 0.5, HEIGHT * 0.4
    b.click(x, y, times=2)
    b.wait(f"kdray.state.camera.at.some((v, k) => v !== {c['at']}[k])")
    rest(b)
    print("ok  double click: turns about", camera(b)["at"])


def touches(b):
    """One finger orbits, two pan and zoom, a tap picks."""
    b.key("Escape", "Escape")
    b.key("KeyR", "r")
    rest(b)
    x, y = MIDDLE
    before = camera(b)
    b.touch([(x + 8 * i, y + 2 * i) for i in range(10)])
    rest(b)
    now = camera(b)
    assert near(now["at"], before["at"]) and now["from"] != before["from"], "one finger orbits"
    assert math.isclose(distance(now), distance(before), rel_tol=1e-5)
    before = now
    b.touch([(x - 40 - 6 * i, y) for i in range(10)], [(x + 40 + 6 * i, y) for i in range(10)])
    rest(b)
    assert distance(camera(b)) < 0.6 * distance(before), "two fingers that part zoom in"
    before = camera(b)
    b.touch([(x - 40 + 6 * i, y + 3 * i) for i in range(10)], [(x + 40 + 6 * i, y + 3 * i) for i in range(10)])
    rest(b)
    now = camera(b)
    moves = [[q - p for p, q in zip(before[k], now[k])] for k in ("from", "at")]
    assert math.dist(*moves) < 1e-5 * distance(now) and math.hypot(*moves[0]) > 0, "two fingers side by side pan"
    assert b.ask("document.getElementById('picked').hidden")
    b.key("KeyR", "r")
    rest(b)
    b.touch([MIDDLE])
    b.wait("!document.getElementById('picked').hidden")
    b.key("Escape", "Escape")
    print("ok  touch: orbit, zoom, pan, tap")


def looks(b, folder):
    """A studio in place of the file's own camera and lights, and back."""
    assert b.ask("document.getElementById('look').value") == "as given"
    given = check_picture(b, folder, "as given")
    seen = {given}
    for look in ("studio", "plain"):
        choose(b, "look", look)
        seen.add(check_picture(b, folder, f"look {look}"))
    assert len(seen) == 2, "plain is as given here, a studio isn't"
    choose(b, "look", "as given")
    assert check_picture(b, folder, "as given again") == given


def owners(b, folder):
    """Who traced it: in ODPRT the subtrees' queues, the same each time; in PDPRT whoever took the tile."""
    for name, value in (("channel", "queue"), ("queues", "2"), ("mode", "odprt")):
        choose(b, name, value)
    check_picture(b, folder, "who traced it, odprt")
    told = b.ask("document.getElementById('owners').innerText")
    assert "queue 1" in told and "subtrees" in told and "left" in told and "travelled" in told, told
    b.screenshot(os.environ.get("KDRAY_SHOT_OWNERS", os.devnull))
    choose(b, "mode", "pdprt")
    rest(b)
    told = b.ask("document.getElementById('owners').innerText")
    assert "tiles" in told and "travelled" not in told, told
    print("ok  who traced it:", told.replace("\n", " | "))
    for name, value in (("mode", "auto"), ("queues", "0")):
        choose(b, name, value)
    rest(b)


def channels(b, folder):
    seen = set()
    for channel in ("depth", "normal", "primitive", "cost", "samples"):
        choose(b, "channel", channel)
        seen.add(check_picture(b, folder, channel))
    assert len(seen) == 5
    owners(b, folder)
    choose(b, "channel", "")
    check_picture(b, folder, "the picture again")
    for name, value in (("mode", "odprt"), ("queues", "2"), ("traversal", "packet"), ("headlight", "8"),
                        ("depth", "2"), ("samples", "4")):  # fmt: skip
        choose(b, name, value)
        check_picture(b, folder, f"{name} {value}")
    for name, value in (("mode", "auto"), ("queues", "0"), ("traversal", "auto"), ("headlight", "0"),
                        ("depth", "5"), ("samples", "adaptive")):  # fmt: skip
        choose(b, name, value)
    rest(b)
    choose(b, "cells", "8")
    b.wait("kdray.state.boxes.length > 10")
    n = b.ask("[...document.getElementById('lines').getContext('2d').getImageData(0, 0, 640, 480).data].filter(x => x).length")
    assert n > 1000, "the cells are drawn"
    choose(b, "cells", "0")
    assert "Mrays/s" in b.ask("document.getElementById('figures').textContent")
    b.click(*b.ask("(r => [r.x + 5, r.y + 5])(document.getElementById('more').getBoundingClientRect())"))
    assert "shadow" in b.ask("document.getElementById('details').textContent")
    print("ok  cells and figures")


def address(b, viewer, folder):
    assert "token" not in b.ask("location.hash"), "the token leaves the address"
    b.drag(MIDDLE, (MIDDLE[0] + 50, MIDDLE[1]))
    before = check_picture(b, folder, "before reloading the page"), camera(b)
    b.wait("location.hash.includes('camera=')")
    assert b.ask("location.hash.length") < 160, b.ask("location.hash")
    b.ask("window.isOld = true")
    b.reload()
    b.wait("!window.isOld && window.kdray?.state.scene")
    assert (check_picture(b, folder, "after it"), camera(b)) == before, "the view is in the address"
    resize(b, 500, 400)
    assert b.ask("kdray.screen.picture.getBoundingClientRect().width") <= 500
    resize(b, WIDTH, HEIGHT + 30)
    b.key("KeyC", "c")
    b.wait("document.getElementById('said').textContent.startsWith('kdray render ')")
    assert b.ask("document.getElementById('said').textContent") == b.ask("kdray.state.command")
    print("ok  resize, copied command")


def reload(b, scene, folder):
    """The file changes: its picture does, the camera doesn't. A broken one leaves the picture."""
    text = scene.read_text()
    rest(b)  # what came before may have left a picture on its way
    before, where = hashlib.sha256(png(b)).hexdigest(), camera(b)
    scene.write_text("this is no scene\n")
    b.wait("!document.getElementById('problem').hidden")
    told = b.ask("document.getElementById('problem').textContent")
    assert scene.name + ":1" in told, told
    assert hashlib.sha256(png(b)).hexdigest() == before, "the last good picture stays"
    scene.write_text(text.replace("b ", "b 0.3 0.0 0.1\n# ", 1))
    b.wait("document.getElementById('problem').hidden")
    assert check_picture(b, folder, "the changed file") != before
    assert camera(b) == where
    scene.write_text(text)
    print("ok  reload; a broken file:", told)


def several(b, folder, other):
    b.ask("(e => { e.value = '1'; e.onchange(); })(document.getElementById('scene'))")
    b.wait("kdray.state.scene.scene === 1")
    check_picture(b, folder, f"another scene, {other}")
    b.ask("(e => { e.value = '0'; e.onchange(); })(document.getElementById('scene'))")
    b.wait("kdray.state.scene.scene === 0")
    check_picture(b, folder, "and the first again")


def no_token(viewer):
    with Browser(WIDTH, HEIGHT + 30) as b:
        b.open(viewer.address.split("#")[0])
        b.wait("document.getElementById('problem')?.textContent.includes('Copy the whole address')")
    print("ok  a page without its token says what to do")


def endings(scene):
    viewer = Viewer(kdray, scene)
    viewer.process.send_signal(signal.SIGINT)
    seconds = viewer.ends()
    assert viewer.process.returncode == -signal.SIGINT
    viewer.close()
    print(f"ok  Ctrl-C ends it within {seconds:.2f} s")
    viewer = Viewer(kdray, scene)
    viewer.process.stdin.close()  # the terminal, or ssh, is gone
    viewer.ends()
    assert viewer.process.returncode == 0
    viewer.process.stdin = None
    viewer.close()
    viewer = Viewer(kdray, scene, "--linger", "0.5")
    with Browser(WIDTH, HEIGHT + 30) as b:
        b.open(viewer.address)
        b.wait("window.kdray?.state.scene")
    viewer.ends()
    assert viewer.process.returncode == 0
    viewer.close()
    # The page goes without a farewell, as with a network that is gone, while a picture is being rendered.
    viewer = Viewer(kdray, scene, "--linger", "0.5", "--samples", "1024")
    with Browser(WIDTH, HEIGHT + 30) as b:
        b.open(viewer.address)
        b.wait("window.kdray?.state.scene")
    viewer.ends()
    viewer.close()
    print("ok  closing the terminal or the page ends it")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene = folder / "scene.nff"
        shutil.copy(sys.argv[2], scene)
        others = sys.argv[3:]
        viewer = Viewer(kdray, scene, *others)
        try:
            with Browser(WIDTH, HEIGHT + 30) as b:
                b.open(viewer.address)
                b.wait("window.kdray?.state.scene")
                try:
                    mouse_and_keys(b, folder)
                    picks(b)
                    touches(b)
                    looks(b, folder)
                    channels(b, folder)
                    address(b, viewer, folder)
                    reload(b, scene, folder)
                    if others:
                        several(b, folder, others[0])
                    assert not b.faults(), b.faults()
                    no_token(viewer)
                except BaseException:
                    b.screenshot(os.environ.get("KDRAY_SHOT", os.devnull))
                    print(b.ask("(({scene, png, ...s}) => JSON.stringify(s))(kdray.state)"), "link", b.ask("kdray.view.link?.open"))
                    print(b.faults(), b.ask("document.getElementById('problem').textContent"))
                    raise
        finally:
            viewer.close()
        endings(scene)


main()
