#!/usr/bin/env python3
"""`kdray view`'s page by keyboard alone, on screens of four sizes, and under axe-core's rules for WCAG.

    access_test.py KDRAY SCENE

Skips (status 77) where there is no Chromium. axe-core is the file that KDRAY_AXE names, or that of the packages
axe-core-python (PyPI) or node-axe-core (Debian); where there is none, a line says that its rules were not tried.
"""

import importlib.util
import math
import os
import pathlib
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from browser import Browser  # noqa: E402
from viewer import Viewer, camera, choose, compare, distance, near, resize, rest  # noqa: E402

SHIFT = 8
SIZES = {"phone": (390, 844), "tablet": (820, 1180), "notebook": (1280, 720), "desktop": (1920, 1080)}
SHOTS = os.environ.get("KDRAY_SHOTS")
KEYS = {"Tab": 9, "Enter": 13, "Escape": 27, "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39}

if not Browser.find():
    print("skipped: there is no chromium here (Debian: chromium)")
    sys.exit(77)
kdray = os.path.abspath(sys.argv[1])


def axe():
    package = importlib.util.find_spec("axe_core_python")
    places = [*(package.submodule_search_locations if package else []), "/usr/share/nodejs/axe-core"]
    files = [os.environ.get("KDRAY_AXE"), *(pathlib.Path(p) / "axe.min.js" for p in places)]
    return next((pathlib.Path(f).read_text() for f in files if f and os.path.exists(f)), None)


def is_open(b, name):
    return b.ask(f"(e => e.open ?? !e.hidden)(document.getElementById('{name}'))")


def wait_closed(b, name):
    b.wait(f"!(e => e.open ?? !e.hidden)(document.getElementById('{name}'))")


def focus(b):
    return b.ask("document.activeElement.id || document.activeElement.className")


def middle(b, selector):
    return b.ask(f"(r => [r.x + r.width / 2, r.y + r.height / 2])(document.querySelector('{selector}').getBoundingClientRect())")


def press(b, key, modifiers=0):
    """A key as a keyboard sends it, for what the browser itself does with it."""
    more = {"windowsVirtualKeyCode": KEYS[key]} if key in KEYS else {"text": key}
    if key == "Enter":
        more["text"] = "\r"
    code = key if key in KEYS else {"+": "Equal", "-": "Minus"}.get(key, "Key" + key.upper())
    b.call("Input.dispatchKeyEvent", type="keyDown", key=key, code=code, modifiers=modifiers, **more)
    b.call("Input.dispatchKeyEvent", type="keyUp", key=key, code=code, modifiers=modifiers)


def tab_to(b, name):
    for _ in range(40):
        if focus(b) == name:
            return
        press(b, "Tab")
    raise AssertionError(f"Tab never comes to {name}")


def keyboard(b):
    rest(b)
    tab_to(b, "picture")
    assert b.ask("getComputedStyle(document.activeElement).outlineStyle") == "solid", "the picture's focus is seen"
    start = camera(b)
    press(b, "ArrowLeft")
    press(b, "ArrowUp")
    rest(b)
    turned = camera(b)
    assert near(turned["at"], start["at"]) and turned["from"] != start["from"], "arrow keys orbit"
    assert math.isclose(distance(turned), distance(start), rel_tol=1e-5)
    press(b, "ArrowRight", SHIFT)
    rest(b)
    moved = camera(b)
    moves = [[q - p for p, q in zip(turned[k], moved[k])] for k in ("from", "at")]
    assert math.dist(*moves) < 1e-5 * distance(moved) < math.hypot(*moves[0]), "with shift they pan"
    press(b, "+")
    rest(b)
    assert math.isclose(distance(camera(b)) * 1.1, distance(moved), rel_tol=1e-5), "plus zooms in"
    press(b, "-")
    rest(b)
    assert math.isclose(distance(camera(b)), distance(moved), rel_tol=1e-5), "minus zooms out"

    tab_to(b, "open-panel")
    press(b, "Enter")
    assert is_open(b, "panel") and focus(b) == "close", focus(b)
    tab_to(b, "depth")
    press(b, "ArrowLeft")
    assert b.ask("document.getElementById('depth').getAttribute('aria-valuetext')") == "4"
    tab_to(b, "open-help")
    press(b, "Enter")
    assert is_open(b, "help")
    where = camera(b)
    press(b, "w")
    press(b, "ArrowLeft")
    assert camera(b) == where, "keys don't reach the picture below a dialog"
    for _ in range(5):
        press(b, "Tab")
        assert b.ask("[document.body, ...document.querySelectorAll('#help *')].includes(document.activeElement)")
    press(b, "Escape")
    assert not is_open(b, "help") and is_open(b, "panel") and focus(b) == "open-help", "Esc closes what lies on top"
    tab_to(b, "close")
    press(b, "Escape")
    assert not is_open(b, "panel") and focus(b) == "open-panel", focus(b)
    press(b, "r")
    rest(b)
    print("ok  by keyboard alone")


def settings(b, folder):
    before = camera(b)["up"]
    b.ask("(e => { e.value = '1,0,0'; e.dispatchEvent(new Event('change')); })(document.getElementById('up'))")
    rest(b)
    assert camera(b)["up"] == [1, 0, 0] != before, "another axis is up"
    press(b, "r")
    rest(b)
    assert camera(b)["up"] == before
    choose(b, "backdrop", "chosen")
    choose(b, "background", "#ff8000")
    assert "--background 1,0.21" in rest(b)
    compare(kdray, b, folder, "background")
    choose(b, "backdrop", "")
    choose(b, "headlight", "8")
    assert "--headlight 0.8" in rest(b)
    choose(b, "headlight", "0")
    choose(b, "mode", "pdprt")
    assert "the queues divide the picture" in b.ask("document.getElementById('mode-means').innerText"), "pdprt is explained"
    choose(b, "mode", "auto")
    print("ok  up axis, background, light, what a mode means")


def smooth(b, folder, flat):
    """The file is read again, and its faces have no edges any more; the page stays where it is."""

    def read_with(degrees):
        seen = b.ask("kdray.state.scene.smooth")
        b.ask(f"(e => {{ e.value = {degrees}; e.dispatchEvent(new Event('change')); }})(document.getElementById('smooth'))")
        b.wait(f"kdray.state.scene.smooth === {degrees} && {degrees} !== {seen}")
        return rest(b)

    before = camera(b)
    assert "--smooth 90" in read_with(90)
    assert compare(kdray, b, folder, "smooth") != flat
    assert camera(b) == before
    assert b.ask("document.getElementById('smooth-out').value") == "edges up to 90°"
    assert "--smooth" not in read_with(0)
    assert compare(kdray, b, folder, "flat again") == flat


def looks(b, folder):
    """A scene with neither camera nor lights, in a studio and without; its picture is the command's in both."""
    scene = folder / "roof.obj"
    scene.write_text("v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 1 0\nf 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\n")
    viewer = Viewer(kdray, scene)
    try:
        b.open(viewer.address)
        b.wait("window.kdray?.state.scene?.names[0] === 'roof.obj'")
        assert b.ask("document.getElementById('look').value") == "studio"
        studio = compare(kdray, b, folder, "studio")
        choose(b, "look", "plain")
        assert "--look plain" in rest(b)
        assert compare(kdray, b, folder, "plain") != studio
        choose(b, "look", "studio")
        assert compare(kdray, b, folder, "studio again") == studio
        smooth(b, folder, studio)
    finally:
        viewer.close()
    print("ok  looks")


OVERLAPS = """(() => {
  const seen = [...document.querySelectorAll('#bar, #strip, #panel[open]')].map(e => [e.id, e.getBoundingClientRect()]);
  return seen.flatMap(([a, p], i) => seen.slice(i + 1).filter(([, q]) => p.left < q.right && q.left < p.right &&
    p.top < q.bottom && q.top < p.bottom).map(([b]) => a + ' ' + b));
})()"""
UNNAMED = """[...document.querySelectorAll('input, select, button')].filter(e => ![...(e.labels ?? []), e]
    .some(l => l.ariaLabel || l.textContent.trim())).map(e => e.outerHTML)"""
FAULTS = """axe.run({runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa']}).then(r => r.violations
    .filter(v => ['serious', 'critical'].includes(v.impact))
    .map(v => v.id + ': ' + v.nodes.map(n => n.target).join(' ')))"""


def check(b, name, opened, rules):
    width, height = SIZES[name]
    if opened:
        left, top, right, bottom = b.ask(
            f"(r => [r.left, r.top, r.right, r.bottom])(document.getElementById('{opened}').getBoundingClientRect())"
        )
        assert left >= 0 and top >= 0 and right <= width and bottom <= height, (name, opened, left, top, right, bottom)
    b.wait(f"!{OVERLAPS}.length")  # what the strip has grown to is known a frame later
    if SHOTS:
        b.screenshot(f"{SHOTS}/{name}-{opened or 'closed'}.png")
    if rules:
        assert not (found := b.ask(FAULTS)), (name, opened, found)


def layout(b, name, rules):
    width, height = SIZES[name]
    resize(b, width, height)
    check(b, name, None, rules)
    for button, opened in (("open-panel", "panel"), ("more", "details"), ("open-help", "help")):
        b.click(*middle(b, f"#{button}"))
        b.wait(f"(e => e.open ?? !e.hidden)(document.getElementById('{opened}'))")
        check(b, name, opened, rules)
    b.click(*middle(b, "#help .close"))
    b.click(*middle(b, "#more"))
    for closed in ("help", "details"):
        wait_closed(b, closed)
    if name == "phone":
        rest(b)  # at which the camera's digits are cut
        before = camera(b)
        b.click(width / 2, 120)
        wait_closed(b, "panel")
        assert camera(b) == before, "a tap outside closes the settings, and nothing else"
        assert b.ask("document.getElementById('picked').hidden")
        b.click(*middle(b, "#open-panel"))
    b.click(*middle(b, "#panel .close"))
    wait_closed(b, "panel")
    print(f"ok  {name}, {width}x{height}")


def main():
    rules = axe()
    if rules is None:
        print("skipped: axe-core's rules (PyPI: axe-core-python, Debian: node-axe-core)")
    viewer = Viewer(kdray, os.path.abspath(sys.argv[2]))
    try:
        with Browser(*SIZES["notebook"]) as b, tempfile.TemporaryDirectory() as folder:
            if rules:
                b.call("Page.addScriptToEvaluateOnNewDocument", source=rules)
            b.open(viewer.address)
            b.wait("window.kdray?.state.scene")
            keyboard(b)
            settings(b, pathlib.Path(folder))
            assert not (found := b.ask(UNNAMED)), found
            for name in SIZES:
                layout(b, name, rules)
            assert not b.faults(), b.faults()
            looks(b, pathlib.Path(folder))
    finally:
        viewer.close()


main()
