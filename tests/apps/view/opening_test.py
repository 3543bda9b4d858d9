#!/usr/bin/env python3
"""Where `kdray view` serves its page, and how it opens it: --open, --bind, --port.

    opening_test.py KDRAY SCENE

A script stands in for xdg-open, which tells what it was given.
"""

import os
import pathlib
import re
import signal
import socket
import stat
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from page_client import PATIENCE, PageClient  # noqa: E402

kdray, scene = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])


class Served:
    """kdray view with these options; a context manager, whose `said` is all of stderr once it has ended."""

    def __init__(self, *options, **environment):
        self.process = subprocess.Popen(
            [kdray, "view", scene, *options], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            text=True, env={**os.environ, **environment},
        )  # fmt: skip
        self.address = self.process.stdout.readline().strip()
        assert self.address, self.process.stderr.read()
        self.said = ""
        self.wait_for("Ctrl-C ends this")

    def wait_for(self, words):
        while words not in self.said:
            line = self.process.stderr.readline()
            assert line, self.said
            self.said += line

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGINT)
        self.said += self.process.communicate(timeout=PATIENCE)[1]


def status(address, host):
    try:
        with urllib.request.urlopen(urllib.request.Request(address, headers={"Host": host}), timeout=PATIENCE) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        return error.code


def opens(folder):
    told = folder / "told"
    browser = folder / "xdg-open"
    # A browser reads the file at its own time.
    browser.write_text(f'#!/bin/sh\nsleep 0.2\nstat -c %a "$1" >"{told}.new"\necho "$1" >>"{told}.new"\n'
                       f'cat "$1" >>"{told}.new"\nmv "{told}.new" "{told}"\n')  # fmt: skip
    browser.chmod(0o755)
    with Served("--open", PATH=f"{folder}:{os.environ['PATH']}") as served:
        end = time.monotonic() + PATIENCE
        while not told.exists() and time.monotonic() < end:
            time.sleep(0.05)
        mode, file, text = told.read_text().split("\n", 2)
        assert f"url={served.address}" in text, text
        token = served.address.split("=")[1]
        assert token not in file, "command lines are for all to see"
        assert stat.S_IMODE(os.stat(pathlib.Path(file).parent).st_mode) & 0o077 == 0, "the folder is this user's"
    assert not pathlib.Path(file).exists(), "the file with the token goes"
    print(f"ok  --open: {file}, {mode}")
    only_this = folder / "nothing"
    only_this.mkdir()
    with Served("--open", PATH=str(only_this)) as served:
        served.wait_for("there is no xdg-open here")
    print("ok  --open without xdg-open")


def binds():
    with Served("--no-open") as served:
        port = int(re.match(r"http://127\.0\.0\.1:(\d+)/", served.address)[1])
        with socket.socket() as elsewhere:
            elsewhere.settimeout(2)
            own = own_address()
            if own:
                assert elsewhere.connect_ex((own, port)) != 0, "it is served to this machine alone"
    assert f"ssh -L {port}:127.0.0.1:{port} " in served.said and "warning" not in served.said, served.said
    with Served("--no-open", "--bind", "0.0.0.0") as served:
        page = served.address.split("#")[0]
        if own:
            assert status(page.replace("127.0.0.1", own), f"{own}:1234") == 200
        assert status(page, "evil.example") == 403
        client = PageClient(served.address)
        client.receive_until("scene")
        client.close()
    assert "warning: the page is served at 0.0.0.0" in served.said and "encrypted" in served.said, served.said
    print("ok  --bind 0.0.0.0 serves", own or "this machine")
    if socket.has_ipv6 and has_v6_loopback():
        with Served("--no-open", "--bind", "::1") as served:
            assert served.address.startswith("http://[::1]:"), served.address
            client = PageClient(served.address)
            client.receive_until("scene")
            client.close()
        assert "warning" not in served.said
        print("ok  --bind ::1")
    for options, why in ((("--bind", "example.org"), "in numbers"), (("--bind", "192.0.2.1"), "can't listen"),
                         (("--port", "0"), "--port"), (("--open", "--no-open"), "--open")):  # fmt: skip
        done = subprocess.run([kdray, "view", scene, *options], capture_output=True, text=True, timeout=PATIENCE)
        assert done.returncode in (1, 2) and why in done.stderr and done.stderr.count("\n") == 1, done.stderr
    print("ok  what is refused")


def own_address():
    """The machine's address in its network, if it has one; nothing is sent."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))
        except OSError:
            return None
        return probe.getsockname()[0]


def has_v6_loopback():
    with socket.socket(socket.AF_INET6) as probe:
        try:
            probe.bind(("::1", 0))
        except OSError:
            return False
    return True


with tempfile.TemporaryDirectory() as name:
    opens(pathlib.Path(name))
binds()
