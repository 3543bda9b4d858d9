#!/usr/bin/env python3
"""check_includes.py refuses a module that includes a header of a module above it, the public header of the API among them, and a group that
links one below it."""

import pathlib
import subprocess
import sys
import tempfile

check = pathlib.Path(__file__).with_name("check_includes.py")


def outcome(low_includes, low_links=""):
    """Of a tree of two modules, `api` above `base/low`, whose file includes what is given."""
    with tempfile.TemporaryDirectory() as folder:
        files = {
            "host/CMakeLists.txt": "foreach(module base/low api)\nendforeach()",
            "host/include/kdray/plain.h": "",
            "host/include/kdray/kdray.h": "",
            "host/base/low/CMakeLists.txt": f"kdray_module(low SOURCES low.cpp {low_links})",
            "host/base/low/low.cpp": low_includes,
            "host/api/CMakeLists.txt": "kdray_module(api SOURCES api.cpp PUBLIC kdray::low)",
            "host/api/api.cpp": '#include "kdray/plain.h"\n#include "kdray/kdray.h"\n#include "base/low/low.h"\n',
            "bench/CMakeLists.txt": "",
        }
        for name, text in files.items():
            path = pathlib.Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return subprocess.run([sys.executable, check, folder], capture_output=True, text=True)


assert outcome('#include "kdray/plain.h"\n').returncode == 0
for above in ("kdray/kdray.h", "api/job.h"):
    refused = outcome(f'#include "{above}"\n')
    assert refused.returncode == 1, above
    assert "low.cpp:1: module base/low includes api/" in refused.stdout, refused.stdout
upward = outcome("", "PUBLIC kdray::api")
assert upward.returncode == 1 and "it links api, whose group stands below its own" in upward.stdout, upward.stdout
print("includes of modules above are refused")
