"""Which OpenCL driver there is: the system's, or where it has none, the one of the extra `kdray[pocl]`.

An OpenCL loader reads its environment once, so this is done before anything asks it for platforms.
"""

from __future__ import annotations

import ctypes
import os
import pathlib
import shutil
import threading

_lock = threading.Lock()
_chosen: str | None = None


def choose() -> str:
    """Sees to it that there is a driver; says in a few words which. Does so once."""
    global _chosen
    with _lock:
        if _chosen is None:
            _chosen = _choose()
    return _chosen


def program() -> pathlib.Path:
    """The `kdray` of the command line, which comes with the package."""
    return pathlib.Path(__file__).parent / "bin" / "kdray"


def _choose() -> str:
    own = program()
    if own.exists():  # kdray tries drivers in a process of its own
        os.environ.setdefault("KDRAY_PROGRAM", str(own))
    for name in ("OCL_ICD_VENDORS", "OCL_ICD_FILENAMES"):
        if os.environ.get(name):
            return f"as {name} says"
    if _system_has_one():
        return "the system's"
    try:
        import kdray_pocl
    except ModuleNotFoundError:
        return "none"
    os.environ["OCL_ICD_VENDORS"] = str(kdray_pocl.driver())
    # PoCL links each kernel with `ld`, against the compiler's libraries; bare machines have neither.
    if not (shutil.which("ld") and shutil.which("cc")):
        path = os.environ.get("PATH", os.defpath)
        os.environ["PATH"] = f"{kdray_pocl.linker()}{os.pathsep}{path}"
    return "PoCL of the extra kdray[pocl]"


def _system_has_one() -> bool:
    folder = pathlib.Path(os.environ.get("OPENCL_VENDOR_PATH", "/etc/OpenCL/vendors"))
    for file in sorted(folder.glob("*.icd")):
        try:
            library = file.read_text().split()[0]
            ctypes.CDLL(library)
        except (OSError, IndexError):
            continue  # its library is gone, or can't be loaded
        return True
    return False
