"""What a figure was measured with: the processor, its cores, and versions of what is installed."""

from __future__ import annotations

import ctypes
import importlib
import importlib.metadata
import os
import pathlib
import platform
from typing import Any

import numpy as np

from .. import __version__

EMBREE3 = "libembree3.so.3"


def module(name: str) -> Any:
    """The module of that name, or the shared library (lib...), or None where it can't be loaded."""
    try:
        return ctypes.CDLL(name) if name.startswith("lib") else importlib.import_module(name)
    except Exception:  # whatever keeps it from being imported, it isn't there
        return None


def cores() -> int:
    """Those that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1


def processor() -> str:
    """Its name, as the system tells it."""
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def versions() -> dict[str, str]:
    """Of Python, NumPy, kdray and of the others that are installed."""
    found = {"python": platform.python_version(), "numpy": np.__version__, "kdray": __version__}
    for name in ("embreex", "trimesh", "open3d", "open3d-cpu"):
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    embree = module(EMBREE3)
    if embree is not None:
        embree.rtcNewDevice.restype = ctypes.c_void_p
        number = embree.rtcGetDeviceProperty(ctypes.c_void_p(embree.rtcNewDevice(None)), 0)
        found["embree3"] = f"{number // 10000}.{number // 100 % 100}.{number % 100}"
    return found
