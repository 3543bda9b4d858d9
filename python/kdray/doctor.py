"""`python -m kdray doctor`: what there is to trace with, and what to do where there is nothing."""

from __future__ import annotations

import platform
import sys

import numpy as np

from . import __version__, _core, _drivers
from .devices import Device, devices_and_left_out
from .errors import Error
from .scene import Scene


def doctor() -> int:
    """Writes its findings to stdout; the exit status: 0 where a ray could be traced, else 3."""
    print(f"kdray {__version__}, Python {platform.python_version()}, NumPy {np.__version__}")
    print(f"OpenCL driver: {_drivers.choose()}")
    print(f"compiled programs are kept in {_core.program_folder() or 'no folder'}")
    found, left_out = devices_and_left_out()
    for line in left_out:
        print(f"left out: {line}")
    for device in found:
        print(_line_of(device))
    if not any(device.usable for device in found):
        print("there is no device: install an OpenCL driver, or PoCL by `pip install 'kdray[pocl]'`")
        return 3
    return _trace_one_ray()


def _line_of(device: Device) -> str:
    if not device.usable:
        return f"{device.number}  {device.name}: not usable: {device.why_not}"
    return (
        f"{device.number}  {device.name}: {device.kind}, {device.compute_units} compute units, "
        f"{device.memory / 2**30:.1f} GiB, {device.vectors}"
    )


def _trace_one_ray() -> int:
    try:
        scene = Scene()
        scene.add_spheres([0, 0, 0], 1)
        t = float(scene.closest_hit([0, 0, 5], [0, 0, -1]).t)
    except Error as error:
        print(f"a ray can't be traced: {error}", file=sys.stderr)
        return 3
    print(f"a ray was traced: t = {t:g}, as it should be" if t == 4 else f"a ray was traced wrongly: t = {t}")
    return 0 if t == 4 else 3
