#!/usr/bin/env python3
"""Looks that no user would ask for: cameras that see nothing, channels, modes and sizes at random.

    odd_looks_test.py KDRAY SCENE [LOOKS]

Each is answered, by a frame or by a line that says what is wrong, and a page that comes after them is served as before. The seed is
printed.
"""

import os
import random
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from page_client import VIEW_REQUEST, PageClient  # noqa: E402
from viewer import Viewer  # noqa: E402

kdray, scene = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
LOOKS = int(sys.argv[3]) if len(sys.argv) > 3 else 60
NUMBERS = (0, 1, -1, 0.5, 1e-300, -1e-30, 1e-8, 3, 1e6, 1e30, -1e150, 1e300, 2.5)


def odd_request(random):
    vector = lambda: [random.choice(NUMBERS) for _ in range(3)]  # noqa: E731
    camera = dict(VIEW_REQUEST["camera"])
    for name in ("from", "at", "up"):
        if random.random() < 0.4:
            camera[name] = vector()
    if random.random() < 0.2:
        camera["at"] = camera["from"]
    if random.random() < 0.3:
        camera["fov"] = random.choice((1e-3, 179.9, 1, 90))
    if random.random() < 0.3:
        camera["ortho"] = random.choice((1e-300, 1e-9, 1, 1e9, 1e300))
    width, height = random.choice((1, 2, 15, 64, 333)), random.choice((1, 2, 15))  # 256 samples of 64 bounces each may be asked
    if random.random() < 0.5:
        width, height = height, width
    return {
        **VIEW_REQUEST, "camera": camera, "width": width, "height": height, "depth": random.choice((0, 1, 5, 64)),
        "samples": random.choice((0, 1, 3, 16, "adaptive")), "weight": random.choice((-1, 0, 1e-6, 1)),
        "headlight": random.choice((0, 0.5, 1000)), "mode": random.choice(("auto", "pdprt", "odprt")),
        "channel": random.choice(("", "depth", "normal", "primitive", "cost", "samples", "queue")),
        "traversal": random.choice(("auto", "binary", "wide", "packet", "batch")), "queues": random.choice((0, 0, 0, 1, 2, 3)),
    }  # fmt: skip


def answer_to(page, number):
    """How a look ended: "final" or "moving", or what is wrong with it."""
    while True:
        message = page.receive()
        if message["type"] == "problem":
            return message["text"]
        if message["type"] == "frame" and message["look"] == number and message["kind"] in ("final", "moving"):
            return message["kind"]


def main():
    seed = int(os.environ.get("KDRAY_SEED", random.SystemRandom().randrange(1 << 32)))
    print(f"seed {seed}, {LOOKS} looks", flush=True)
    odd, answers = random.Random(seed), {}
    viewer = Viewer(kdray, scene)
    try:
        page = PageClient(viewer.address)
        page.receive_until("scene")
        for i in range(LOOKS):
            moving = odd.random() < 0.3
            page.look(moving, **odd_request(odd))
            told = answer_to(page, page.number)
            assert "\n" not in told, told
            answers[told] = answers.get(told, 0) + 1
            x, y = odd.random(), odd.random()
            page.send({"type": "pick", "number": i, "x": x, "y": y, "sight": odd_request(odd)})
            while True:
                message = page.receive()
                if message["type"] == "picked" or message.get("about") == "pick":
                    break
            assert viewer.process.poll() is None
        good = PageClient(viewer.address)
        good.receive_until("scene")
        good.look(False)
        assert answer_to(good, good.number) == "final"
    finally:
        viewer.close()
    for told, n in sorted(answers.items(), key=lambda item: -item[1]):
        print(f"{n:5d}  {told}")
    assert answers.get("final", 0) > 0


main()
