"""The page of a scene: what `Scene.view` returns."""

from __future__ import annotations

import html
import os
import threading
import weakref
from typing import Any

from . import _core, errors


def _closed(core: Any, over: threading.Event) -> None:
    core.close()
    over.set()


class View:
    """A page that shows a scene, served by this process at `address` until `close`.

    As the last thing in a notebook's cell it is the page itself, in a frame. Elsewhere, open its address in a browser
    of this machine, or of one that comes here by ``ssh -L``. Who has the address may look: it holds a token.
    """

    def __init__(self, scene: Any, core: Any, size: tuple[int, int]) -> None:
        """Made by `Scene.view`."""
        self._scene, self._core, self.size = scene, core, size
        self.address: str = core.address()
        self._over = threading.Event()
        self._process = os.getpid()
        self._finalizer = weakref.finalize(self, _closed, core, self._over)  # at the interpreter's end, too

    @property
    def closed(self) -> bool:
        """Whether the page is served no longer, or by the process that this one was forked off."""
        return self._over.is_set() or self._process != os.getpid()

    def update(self) -> View:
        """Shows the scene as it is now; the camera stays where it is."""
        if self.closed:
            raise errors.UsageError("the page has been closed; make another one with Scene.view()")
        self._core.update(self._scene._ready())
        return self

    def close(self) -> None:
        """Ends the server; the page says that it is gone."""
        self._finalizer()

    def wait(self) -> None:
        """For scripts, which would end otherwise: returns when the page is closed; Ctrl-C closes it."""
        try:
            while not self.closed and not self._over.wait(0.2):
                pass
        finally:
            self.close()

    def __enter__(self) -> View:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return "<kdray.View, closed>" if self.closed else f"<kdray.View at {self.address}>"

    def _repr_html_(self) -> str:
        if self.closed:
            return html.escape(repr(self))
        width, height = self.size
        return (
            f'<iframe src="{html.escape(self.address)}" width="{width}" height="{height}" '
            'style="border: 0; max-width: 100%" allow="clipboard-write; fullscreen"></iframe>'
        )


def page_of(
    core: Any, name: str, camera: list[float] | None, device: str, compute_units: int, port: int, look: str
) -> Any:
    """kdray._core's page, whose server lets notebooks of this machine have it in a frame."""
    if not hasattr(_core, "Page"):
        raise errors.UsageError(
            "this kdray was built without the page: install libboost-dev and libturbojpeg0-dev, and build it anew"
        )
    return _core.Page(core, name, camera, device, compute_units, port, True, look)
