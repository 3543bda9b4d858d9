"""What there is to trace with."""

from __future__ import annotations

from dataclasses import dataclass

from . import _core, _drivers


@dataclass(frozen=True)
class Device:
    """An OpenCL device. `number` or a part of `name` is what ``Scene(device=...)`` takes."""

    number: int
    name: str
    platform: str
    version: str
    driver: str
    kind: str
    compute_units: int
    memory: int
    vectors: str
    double_precision: bool
    usable: bool
    why_not: str


def devices() -> list[Device]:
    """All OpenCL devices. One that fails kdray's self-test is not `usable`, and says why."""
    return devices_and_left_out()[0]


def devices_and_left_out() -> tuple[list[Device], list[str]]:
    """The devices, and a line for each driver that can't be asked for its own."""
    _drivers.choose()
    found, left_out = _core.devices()
    return [Device(**facts) for facts in found], list(left_out)
