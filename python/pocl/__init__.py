"""PoCL for x86-64 CPUs, with all that it loads: `kdray` takes it where the system has no OpenCL driver."""

from __future__ import annotations

import pathlib

_HERE = pathlib.Path(__file__).resolve().parent


def driver() -> pathlib.Path:
    """The library that OpenCL's loader opens."""
    return _HERE / "lib" / "pocl" / "libpocl.so.2"


def linker() -> pathlib.Path:
    """The folder of an `ld`, which PoCL starts once for each kernel."""
    return _HERE / "linker"
