"""The page of a scene: who may have it, what it shows, and its end."""

import http.server
import pathlib
import re
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Iterator

import pytest

import kdray
from kdray import _core

pytestmark = pytest.mark.skipif(not hasattr(_core, "Page"), reason="built without the page")


@pytest.fixture
def page(ball: kdray.Scene) -> Iterator[kdray.View]:
    with ball.view() as view:
        yield view


def answer(view: kdray.View, **headers: str) -> tuple[int, str, dict[str, str]]:
    """Status, text and head of the page's file."""
    request = urllib.request.Request(view.address.split("#")[0], headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=600) as got:
            return got.status, got.read().decode(), dict(got.headers)
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode(), dict(error.headers)


def test_it_is_served_to_this_machine_with_a_token(page):
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/#token=[0-9a-f]{32}", page.address)
    status, text, _ = answer(page)
    assert status == 200 and "kdray view" in text
    assert page.address.split("=")[1] not in text, "the token is for who has the address"
    assert answer(page, Host="evil.example")[0] == 403


def test_only_pages_of_this_machine_may_frame_it(page):
    policy = answer(page)[2]["Content-Security-Policy"]
    ancestors = re.search(r"frame-ancestors ([^;]*)", policy)
    assert ancestors
    assert set(ancestors[1].split()) == {
        f"{scheme}://{name}:*" for scheme in ("http", "https") for name in ("localhost", "127.0.0.1")
    }


def test_notebooks_show_a_frame_and_others_the_address(ball):
    with ball.view(size=(300, 200)) as view:
        assert repr(view) == f"<kdray.View at {view.address}>"
        assert f'<iframe src="{view.address}" width="300" height="200"' in view._repr_html_()
    assert view.closed and "closed" in repr(view) and "iframe" not in view._repr_html_()


def test_close_ends_the_server(ball):
    view = ball.view()
    view.close()
    with pytest.raises(urllib.error.URLError):
        answer(view)
    view.close()
    with pytest.raises(kdray.UsageError, match="closed"):
        view.update()


def test_a_view_that_nobody_holds_is_closed(ball):
    view = ball.view()
    address = view.address.split("#")[0]
    del view
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(address, timeout=600)


def test_wait_returns_when_it_is_closed(ball):
    view = ball.view()
    threading.Timer(0.3, view.close).start()
    view.wait()
    assert view.closed


def test_a_program_ends_with_a_page_that_is_open():
    script = "import kdray; s = kdray.Scene(); s.add_spheres([0, 0, 0], 1); v = s.view(); print(v.address)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0 and done.stdout.startswith("http://127.0.0.1:"), done.stderr


def test_a_port_that_is_taken_is_told(page, ball):
    port = int(page.address.split(":")[2].split("/")[0])
    with pytest.raises(kdray.InputError, match="give another --port"):
        ball.view(port=port)
    for wrong in ({"port": -1}, {"port": 65536}, {"size": (0, 9)}):
        with pytest.raises(kdray.UsageError):
            ball.view(**wrong)


sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests" / "apps" / "view"))
from browser import Browser  # type: ignore[import-not-found]  # noqa: E402
from page_client import PageClient  # type: ignore[import-not-found]  # noqa: E402


@pytest.mark.parametrize("options", [{}, {"look": "plain"}])
def test_it_has_the_look_of_render(ball, tmp_path, options):
    with ball.view(**options) as view:
        page = PageClient(view.address)
        begun = page.receive_until("scene")
        page.look(False, camera=begun["camera"], width=64, height=48, samples=0, look=None)
        page.receive_until("final")
        page.close()
    assert begun["look"] == options.get("look", "studio")
    c = begun["camera"]
    ball.render(kdray.Camera(c["from"], c["at"], c["up"], fov=c["fov"]), (64, 48), **options).save(tmp_path / "a.png")
    assert page.picture == (tmp_path / "a.png").read_bytes()


# ---- In a browser


class Notebook(http.server.BaseHTTPRequestHandler):
    """A page of another origin of this machine, which holds a cell's output."""

    output = ""

    def do_GET(self):
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(f"<!doctype html><body>{self.output}".encode())

    def log_message(self, *_):
        pass


@pytest.fixture
def notebook() -> Iterator[http.server.HTTPServer]:
    server = http.server.HTTPServer(("127.0.0.1", 0), Notebook)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield server
    server.shutdown()
    server.server_close()


def into_frame(browser, address):
    """The browser goes on inside of the frame that shows `address`."""
    outer, browser.session = browser.session, None
    end = time.monotonic() + 600
    while time.monotonic() < end:
        for target in browser.call("Target.getTargets")["targetInfos"]:
            if target["type"] == "iframe" and target["url"].startswith(address.split("#")[0]):
                found = browser.call("Target.attachToTarget", targetId=target["targetId"], flatten=True)
                browser.session = found["sessionId"]
                return
        time.sleep(0.1)
    browser.session = outer
    raise TimeoutError("there is no such frame")


def picked(browser):
    """What the card says of the picture's middle."""
    browser.ask("document.querySelector('#picked dl').replaceChildren(), kdray.view.click(0.5, 0.5)")
    browser.wait("!!document.querySelector('#picked dd')")
    return browser.ask("[...document.querySelectorAll('#picked dd')].map(e => e.textContent)")


@pytest.mark.skipif(not Browser.find(), reason="there is no chromium")
def test_the_frame_shows_the_scene_and_its_changes(ball, notebook):
    with ball.view(kdray.Camera((0, 0, 4), fov=40), size=(400, 300)) as view:
        Notebook.output = view._repr_html_()
        with Browser(500, 400) as b:
            b.open(f"http://localhost:{notebook.server_port}/")
            into_frame(b, view.address)
            b.wait("window.kdray?.state.final", 60)
            assert b.ask("kdray.state.camera.from") == [0, 0, 4]
            assert picked(b)[1] == "3", "the ball is three away"
            ball.add_spheres([[0, 0, 2]], [0.5], name="near")
            b.ask("kdray.state.final = null")
            view.update()
            b.wait("kdray.state.final", 60)
            told = picked(b)
            assert told[0] == "1, near" and told[1] == "1.5", told
            assert b.ask("kdray.state.command") == "", "no command renders what is in memory alone"
