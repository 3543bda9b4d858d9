"""A headless Chromium, driven by the DevTools protocol over a pipe: pages, mouse, keys, screenshots.

Only the standard library is used. `Browser.find()` tells where Chromium is, or nothing.
"""

import base64
import json
import os
import select
import shutil
import signal
import subprocess
import tempfile
import time

from page_client import PATIENCE

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")


class Gone(RuntimeError):
    """The page that was asked is there no more."""


class Browser:
    """One Chromium with one page; a context manager that leaves no process behind."""

    @staticmethod
    def find():
        return next((path for path in map(shutil.which, NAMES) if path), None)

    def __init__(self, width=1024, height=800):
        self.folder = tempfile.mkdtemp(prefix="kdray-browser-")
        to_browser, self.out = os.pipe()
        self.inp, from_browser = os.pipe()
        arguments = [
            self.find(), "--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--mute-audio",
            "--disable-dev-shm-usage", "--disable-renderer-backgrounding", "--disable-backgrounding-occluded-windows", "--disable-extensions", "--disable-background-networking",
            "--hide-scrollbars", f"--window-size={width},{height}", f"--user-data-dir={self.folder}",
            "--remote-debugging-pipe", "about:blank",
        ]  # fmt: skip

        def pipes_as_three_and_four():
            a, b = os.dup(to_browser), os.dup(from_browser)
            os.dup2(a, 3)
            os.dup2(b, 4)

        self.process = subprocess.Popen(
            arguments, preexec_fn=pipes_as_three_and_four, close_fds=False, start_new_session=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(to_browser)
        os.close(from_browser)
        self.buffer, self.number, self.session, self.events = b"", 0, None, []
        target = next(t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page")
        self.session = self.call("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
        self.call("Page.enable")
        self.call("Runtime.enable")
        self.call("Log.enable")
        self.resize(width, height)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.close(self.out)
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self.process.wait()
        os.close(self.inp)
        shutil.rmtree(self.folder, ignore_errors=True)

    # ---- The protocol

    def receive(self, limit):
        end = time.monotonic() + limit
        while b"\0" not in self.buffer:
            if not select.select([self.inp], [], [], max(0, end - time.monotonic()))[0]:
                raise TimeoutError("the browser does not answer")
            data = os.read(self.inp, 1 << 20)
            if not data:
                raise RuntimeError("the browser has gone")
            self.buffer += data
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, limit=PATIENCE, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive(limit)
            if answer.get("id") == self.number:
                if "error" in answer:
                    message = answer["error"]["message"]
                    raise (Gone if "context" in message or "navigated" in message else RuntimeError)(
                        f"{method}: {message}"
                    )
                return answer["result"]
            if "method" in answer:
                self.events.append(answer)

    def faults(self):
        """What the page has complained of: exceptions, errors on the console, refusals of the policy."""
        found = []
        for event in self.events:
            p = event["params"]
            if event["method"] == "Runtime.exceptionThrown":
                details = p["exceptionDetails"]
                found.append(details.get("exception", {}).get("description", details["text"]))
            elif event["method"] == "Log.entryAdded" and p["entry"]["level"] == "error":
                found.append(p["entry"]["text"] + " " + p["entry"].get("url", ""))
            elif event["method"] == "Runtime.consoleAPICalled" and p["type"] == "error":
                found.append(str(p["args"]))
        return found

    # ---- What a user does

    def open(self, address):
        self.call("Page.navigate", url=address)

    def reload(self):
        self.call("Page.reload")

    def resize(self, width, height):
        self.call(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False
        )

    def ask(self, expression, limit=PATIENCE):
        """The value of an expression in the page; promises are waited for."""
        result = self.call(
            "Runtime.evaluate", limit=limit, expression=expression, returnByValue=True, awaitPromise=True
        )
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"].get("exception", {}).get("description", "it threw"))
        return result["result"].get("value")

    def wait(self, expression, limit=PATIENCE):
        end = time.monotonic() + limit
        while not (value := self.ask_a_page_that_may_go(expression)):
            if time.monotonic() > end:
                raise TimeoutError(f"never: {expression}")
            time.sleep(0.02)
        return value

    def ask_a_page_that_may_go(self, expression):
        """Nothing, where the page was left while it was asked."""
        try:
            return self.ask(expression)
        except Gone:
            return None

    def mouse(self, kind, x, y, button="none", buttons=0, clicks=0, modifiers=0, **more):
        self.call(
            "Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, buttons=buttons, clickCount=clicks,
            modifiers=modifiers, **more,
        )  # fmt: skip

    def drag(self, start, end, button="left", modifiers=0, steps=8):
        bit = {"left": 1, "right": 2, "middle": 4}[button]
        self.mouse("mousePressed", *start, button, bit, 1, modifiers)
        for i in range(1, steps + 1):
            point = [a + (b - a) * i / steps for a, b in zip(start, end)]
            self.mouse("mouseMoved", *point, button, bit, 0, modifiers)
            time.sleep(0.02)
        self.mouse("mouseReleased", *end, button, 0, 1, modifiers)

    def click(self, x, y, times=1):
        for i in range(1, times + 1):
            self.mouse("mousePressed", x, y, "left", 1, i)
            self.mouse("mouseReleased", x, y, "left", 0, i)

    def touch(self, *fingers):
        """Fingers go along lists of points at the same time; they touch first and leave last."""
        for i, points in enumerate(zip(*fingers)):
            self.call(
                "Input.dispatchTouchEvent", type="touchMove" if i else "touchStart",
                touchPoints=[{"x": x, "y": y, "id": k} for k, (x, y) in enumerate(points)],
            )  # fmt: skip
            time.sleep(0.02)
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def wheel(self, x, y, by):
        self.mouse("mouseWheel", x, y, deltaX=0, deltaY=by)

    def key(self, code, text, until=None):
        """Presses a key, holds it until an expression of the page is true, if there is one, and lets it go."""
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, code=code, key=text, text=text if kind == "keyDown" and len(text) == 1 else "")
            if kind == "keyDown" and until:
                self.wait(until)

    def screenshot(self, file):
        data = self.call("Page.captureScreenshot", format="png")["data"]
        with open(file, "wb") as out:
            out.write(base64.b64decode(data))
