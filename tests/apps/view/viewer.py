"""`kdray view` as a process, and what its page tells whoever scripts it."""

import base64
import math
import shlex
import subprocess
import time

from page_client import PATIENCE



class Viewer:
    """The server with its printed address; close() leaves nothing behind."""

    def __init__(self, kdray, *arguments, size=(640, 480), **more):
        self.process = subprocess.Popen(
            [kdray, "view", *map(str, arguments), "--no-open", "--size", f"{size[0]}x{size[1]}"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more,
        )  # fmt: skip
        self.address = self.process.stdout.readline().strip()
        assert self.address.startswith("http://127.0.0.1:"), self.process.stderr.read()

    def ends(self, within=PATIENCE):
        """How long it takes to end, which is told and not judged: the machine may be busy."""
        begun = time.monotonic()
        self.process.wait(within)
        return time.monotonic() - begun

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()


def rest(browser, limit=PATIENCE):
    """Waits for the final picture; the command that renders it."""
    time.sleep(0.1)
    browser.wait("kdray.state.final && !kdray.state.changed && !kdray.state.moving && !kdray.state.resizing", limit)
    return browser.ask("kdray.state.command")


def png(browser):
    return base64.b64decode(browser.ask(
        "kdray.state.png.arrayBuffer().then(b => { let t = ''; for (const c of new Uint8Array(b)) "
        "t += String.fromCharCode(c); return btoa(t); })"
    ))  # fmt: skip


def camera(browser):
    return browser.ask("kdray.state.camera")


def distance(c):
    return math.dist(c["from"], c["at"])


def near(p, q):
    """The camera at rest has no more digits than can be seen."""
    return math.dist(p, q) <= 1e-5 * max(1, math.hypot(*q))


def choose(b, name, value):
    b.ask(f"(e => {{ e.value = {value!r}; e.dispatchEvent(new Event('input')); }})(document.getElementById('{name}'))")


def resize(b, width, height):
    """The page hears of it when it is drawn next."""
    b.resize(width, height)
    b.wait(f"innerWidth === {width} && innerHeight === {height}")
    b.ask("new Promise(then => requestAnimationFrame(() => requestAnimationFrame(() => then(1))))")
    rest(b)


def compare(kdray, browser, folder, name, limit=PATIENCE):
    """The page's PNG, which must be the file that its command makes; and compare must agree."""
    command = shlex.split(rest(browser, limit))
    assert command[0] == "kdray", command
    out = folder / "rendered.png"
    subprocess.run([kdray, *command[1:], "-o", out, "-q"], check=True)
    if "--aov" in command:
        out = folder / f"rendered.{command[command.index('--aov') + 1]}.png"
    shown = folder / "shown.png"
    shown.write_bytes(png(browser))
    told = subprocess.run([kdray, "compare", shown, out], check=True, capture_output=True, text=True).stdout
    assert shown.read_bytes() == out.read_bytes(), f"{name}: the PNGs differ: {told}"
    print(f"ok  {name}: {len(shown.read_bytes())} bytes are those of: {shlex.join(command[:3])} ...", flush=True)
    return shown.read_bytes()
