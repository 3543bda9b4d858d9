"""Which OpenCL driver there is: the system's, or where it has none, the one of the extra `kdray[pocl]`.

An OpenCL loader reads its environment once, so this is done before anything asks it for platforms.
"""

from __future__ import annotations

import ctypes
import importlib.metadata
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
    pocl = pocl_of_the_extra()
    if pocl is None:
        return "none"
    os.environ["OCL_ICD_VENDORS"] = str(pocl)
    _lend_linker()
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


def pocl_of_the_extra() -> pathlib.Path | None:
    """The PoCL that pip installed, if it did."""
    try:
        files = importlib.metadata.files("pocl-binary-distribution") or []
    except importlib.metadata.PackageNotFoundError:
        return None
    for file in files:
        if file.name.startswith("libpocl") and ".so" in file.name:
            path = pathlib.Path(str(file.locate()))
            if path.exists():
                return path.resolve()
    return None


def own_linker() -> pathlib.Path | None:
    """The folder of the linker that the wheel brings along."""
    folder = pathlib.Path(__file__).parent / "linker"
    return folder if (folder / "ld").exists() else None


def _lend_linker() -> None:
    """PoCL links each kernel with `ld`, against the compiler's libraries; bare machines have neither."""
    folder = own_linker()
    if folder is None or (shutil.which("ld") and shutil.which("cc")):
        return
    path = os.environ.get("PATH", os.defpath)
    os.environ["PATH"] = f"{folder}{os.pathsep}{path}"
