#!/usr/bin/env python3
"""check_includes.py refuses a room that includes a header of a room above it, a public header of the API among them."""

import pathlib
import subprocess
import sys
import tempfile

check = pathlib.Path(__file__).with_name("check_includes.py")


def outcome(low_includes):
    """Of a tree of two rooms, `api` above `low`, whose file includes what is given."""
    with tempfile.TemporaryDirectory() as folder:
        files = {
            "host/low/CMakeLists.txt": "kdray_room(low SOURCES low.cpp)",
            "host/low/kdray/plain.h": "",
            "host/low/low.cpp": low_includes,
            "host/api/CMakeLists.txt": "kdray_room(api SOURCES api.cpp PUBLIC kdray::low)",
            "host/api/kdray/kdray.h": "",
            "host/api/api.cpp": '#include "kdray/plain.h"\n#include "kdray/kdray.h"\n#include "low/low.h"\n',
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
    assert "low.cpp:1: room low includes api/" in refused.stdout, refused.stdout
print("includes of rooms above are refused")
