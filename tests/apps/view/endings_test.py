#!/usr/bin/env python3
"""How `kdray view` ends, at many moments: while it renders for a page, opens a scene, or does nothing.

    endings_test.py KDRAY SCENE [ROUNDS]

Ctrl-C, SIGTERM, SIGHUP, a terminal that is closed, a pipe that is closed and the last page that goes end it; how
soon is printed. It never leaves a process behind, and its exit status says what ended it. The moments are random; the
seed is printed.
"""

import fcntl
import os
import pty
import random
import signal
import subprocess
import sys
import termios
import threading
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from page_client import PATIENCE, PageClient  # noqa: E402

kdray, scene = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
ROUNDS = int(sys.argv[3]) if len(sys.argv) > 3 else 4
LINGER = 0.2


class Server:
    """`kdray view` in a session of its own, at a terminal or with pipes."""

    def __init__(self, at_terminal, *options):
        self.terminal, ends = None, subprocess.PIPE
        if at_terminal:
            self.terminal, ends = pty.openpty()
        self.process = subprocess.Popen(
            [kdray, "view", scene, "--no-open", "-q", *options],
            stdin=ends, stderr=ends, stdout=subprocess.PIPE, start_new_session=not at_terminal,
            preexec_fn=(lambda: take_terminal(ends)) if at_terminal else None,
        )  # fmt: skip
        if at_terminal:
            os.close(ends)
        self.session = self.process.pid
        self.address = self.process.stdout.readline().decode().strip()
        assert self.address.startswith("http://127.0.0.1:"), self.address

    def left_behind(self):
        """Processes of its session that are still there."""
        found = []
        for name in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open(f"/proc/{name}/stat") as file:
                    fields = file.read().rsplit(")", 1)[1].split()
            except OSError:
                continue
            if int(fields[3]) == self.session and fields[0] != "Z":
                found.append(int(name))
        return found

    def kill(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout, self.process.stderr):
            if stream:
                stream.close()
        if self.terminal is not None:
            os.close(self.terminal)


def take_terminal(descriptor):
    """The child's controlling terminal, so that it is told when that is closed."""
    os.setsid()
    fcntl.ioctl(descriptor, termios.TIOCSCTTY, 0)


class Busy(threading.Thread):
    """A page whose camera moves and rests until the connection ends."""

    def __init__(self, page, seed):
        super().__init__(daemon=True)
        self.page, self.random, self.frames = page, random.Random(seed), 0
        self.start()

    def run(self):
        try:
            self.page.receive_until("scene")
            while True:
                for _ in range(self.random.randrange(6)):
                    self.page.look(True, width=self.random.randrange(16, 900))
                    self.frames += self.page.receive().get("type") == "frame"
                self.page.look(False, width=self.random.randrange(16, 900))
                if self.random.random() < 0.3:
                    self.page.receive_until("final")
        except (OSError, ConnectionError, TimeoutError):
            pass


def ended(server, expected, what):
    begun = time.monotonic()
    try:
        server.process.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        stacks = subprocess.run(["cat", f"/proc/{server.process.pid}/status"], capture_output=True, text=True).stdout
        raise AssertionError(f"{what}: it is still there after {PATIENCE} s\n{stacks}") from None
    seconds = time.monotonic() - begun
    assert server.process.returncode in expected, f"{what}: status {server.process.returncode}"
    assert not server.left_behind(), f"{what}: left behind: {server.left_behind()}"
    return seconds


def signalled(number):
    def end(server, pages):
        server.process.send_signal(number)
        return ended(server, (-number,), number.name)

    return end


def pipe_closed(server, pages):
    server.process.stdin.close()
    return ended(server, (0,), "a pipe that is closed")


def terminal_closed(server, pages):
    os.close(server.terminal)
    server.terminal = None
    return ended(server, (0, -signal.SIGHUP), "a terminal that is closed")


def pages_closed(server, pages):
    for page in pages:
        page.close()
    return ended(server, (0,), "pages that are closed")


# Each with whether kdray is at a terminal.
ENDS = (
    (signalled(signal.SIGINT), False), (signalled(signal.SIGTERM), False), (signalled(signal.SIGHUP), False),
    (pipe_closed, False), (terminal_closed, True), (pages_closed, False),
)  # fmt: skip


def main():
    seed = int(os.environ.get("KDRAY_SEED", random.SystemRandom().randrange(1 << 32)))
    print(f"seed {seed}, {ROUNDS} rounds", flush=True)
    moments, slowest = random.Random(seed), {}
    for _ in range(ROUNDS):
        for end, at_terminal in ENDS:
            server = Server(at_terminal, "--linger", str(LINGER))
            pages = []
            try:
                for _ in range(moments.randrange(1 if end is pages_closed else 0, 3)):
                    pages.append(PageClient(server.address))
                busy = [Busy(page, moments.random()) for page in pages]
                time.sleep(moments.random() ** 2 * 1.5)
                seconds = end(server, pages)
                name = end.__qualname__ if end.__name__ != "end" else f"signal {-server.process.returncode}"
                slowest[name] = max(slowest.get(name, 0), seconds)
                for page in busy:
                    page.join(PATIENCE)
                    assert not page.is_alive(), "a page that was not told"
            finally:
                server.kill()
                for page in pages:
                    page.close()
    for name, seconds in slowest.items():
        print(f"ok  {name}: within {seconds:.2f} s")


main()
