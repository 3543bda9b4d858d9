"""How far a call has come: a bar in terminals and notebooks, or whatever the caller wants."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

Progress = bool | Callable[[float], object]


class Bar:
    """A line on stderr that is drawn anew; nothing for calls that take less than half a second."""

    def __init__(self, what: str) -> None:
        self._what, self._start, self._drawn = what, time.monotonic(), 0.0

    def __call__(self, share: float) -> None:
        """Draws the line for a share of 0 to 1."""
        now = time.monotonic()
        if now - self._start < 0.5 or (now - self._drawn < 0.1 and share < 1):
            return
        self._drawn = now
        spent = now - self._start
        left = f"{spent * (1 - share) / share:.0f} s left" if 0 < share < 1 else f"{spent:.1f} s"
        done = round(30 * share)
        sys.stderr.write(f"\r{self._what} [{'#' * done}{'.' * (30 - done)}] {100 * share:3.0f}%  {left}\x1b[K")
        if share >= 1:
            sys.stderr.write("\n")
        sys.stderr.flush()

    def end(self) -> None:
        """Leaves the line as it is, for what comes after it."""
        if self._drawn:
            sys.stderr.write("\n")


def teller(progress: Progress, what: str) -> Callable[[float], object] | None:
    """The function to be told, if any."""
    if progress is True:
        return Bar(what)
    return progress or None
