#!/usr/bin/env python3
"""Runs the commands that the README and the first screens of the pages show, as they are shown.

    commands_test.py KDRAY SOURCES

They run one after the other, a page at a time, in a folder that is a checkout as the README's first command leaves it: `scripts/run`
stands for the kdray that was built, which is in PATH, and `scenes` is there. Files that the pages say are the reader's own (scene.json,
mesh.ply, rays.npy, ...) are small ones of that kind. Each command has to end with status 0, and to leave what its -o names.

Benches take minutes and run with KDRAY_COMMANDS=all only. Status 77: there is no OpenCL device.
"""

import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile

kdray, sources = (pathlib.Path(p).resolve() for p in sys.argv[1:3])
SCREEN = 60  # lines of a page
PATIENCE = 1200  # seconds
PATIENCE_WITH_BENCHES = 7200  # docs/accuracy.md's takes half an hour
# As tests/support/mpirun.h has them: containers, root, and ranks that share cores.
MPIRUN = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_MCA_plm_rsh_agent": "", "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
}  # fmt: skip
TETRAHEDRON = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
0 0 0\n1 0 0\n0 1 0\n0 0 1
3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3
"""


def npy(rows):
    """A NumPy file of float32 rows (https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html)."""
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({len(rows)}, {len(rows[0])}), }}"
    header = header.ljust(117) + "\n"
    values = [x for row in rows for x in row]
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + struct.pack(f"<{len(values)}f", *values)


def prepare(folder):
    """The checkout, with the reader's own files."""
    shutil.copytree(sources / "scenes", folder / "scenes")
    shutil.copy(sources / "scenes/cornell.json", folder / "scene.json")
    shutil.copy(sources / "scenes/balls.nff", folder / "scene.nff")
    for name in ("mesh.ply", "model.ply", "huge.ply"):
        (folder / name).write_text(TETRAHEDRON)
    (folder / "rays.npy").write_bytes(npy([[0.1, 0.1, 9, 0, 0, 0, -1, 100], [9, 9, 9, 0, 0, 0, 1, 100]]))
    (folder / "points.npy").write_bytes(npy([[0.1, 0.1, 0.1], [2, 0, 0]]))
    (folder / "scripts").mkdir()
    run = folder / "scripts/run"
    run.write_text(f'#!/bin/sh\nexec "{kdray}" "$@"\n')
    run.chmod(0o755)


def commands_of(page, screen):
    """Commands in the blocks of the page's first lines, without comments; lines that end with a backslash are joined."""
    lines = page.read_text().splitlines()[:screen]
    text = "\n".join(line[4:] if line.startswith("    ") else "" for line in lines).replace("\\\n", " ")
    for line in text.splitlines():
        command = re.sub(r"\s+#.*", "", line).strip()
        is_synopsis = re.search(r"COMMAND|\.\.\.|[\[\]$]", command)
        if re.match(r"(kdray|scripts/run|mpirun)\s", command) and not is_synopsis:
            yield command


def run_viewer(command, folder, environment):
    """A page is served until Ctrl-C."""
    process = subprocess.Popen(["sh", "-c", f"exec {command} --no-open"], cwd=folder, env=environment, text=True,
                               stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)  # fmt: skip
    address = process.stdout.readline()
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=PATIENCE)[1]
    assert address.startswith("http://127.0.0.1:"), f"{command}: {said}"


def run(command, folder, environment):
    if re.match(r"\S+ view ", command):
        return run_viewer(command, folder, environment)
    if command.startswith("mpirun "):  # MPI leaves some memory behind
        environment = environment | {"ASAN_OPTIONS": "detect_leaks=0:use_sigaltstack=0"}
    done = subprocess.run(["sh", "-c", command], cwd=folder, env=environment, capture_output=True, text=True,
                          stdin=subprocess.DEVNULL,
                          timeout=PATIENCE_WITH_BENCHES if " bench " in command else PATIENCE)  # fmt: skip
    assert done.returncode == 0, f"{command}: status {done.returncode}: {done.stderr}"
    for output in re.findall(r" (?:-o|--diff|>) ([^\s-]\S*)", command):
        assert (folder / output).exists(), f"{command}: no {output}"


def main():
    if subprocess.run([kdray, "devices"], capture_output=True).returncode != 0:
        print("skipped: no usable OpenCL device")
        sys.exit(77)
    pages = [(sources / "README.md", 1 << 30)] + [(page, SCREEN) for page in sorted((sources / "docs").glob("*.md"))]
    n_run = n_left = 0
    for page, screen in pages:
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            prepare(folder)
            environment = {
                **os.environ, **MPIRUN, "PATH": f"{kdray.parent}:{os.environ['PATH']}", "KDRAY_CACHE_DIR": str(folder / ".cache"),
                "KDRAY_TUNE_FILE": str(folder / ".tune.json"),
            }  # fmt: skip
            for command in commands_of(page, screen):
                left = "no mpirun here" if command.startswith("mpirun") and not shutil.which("mpirun") else ""
                if " bench " in command and os.environ.get("KDRAY_COMMANDS") != "all":
                    left = "takes minutes (KDRAY_COMMANDS=all)"
                if not left:
                    run(command, folder, environment)
                n_left += bool(left)
                n_run += not left
                print(f"{'left' if left else 'ok  '}  {page.relative_to(sources)}: {command}  {left}", flush=True)
    assert n_run > 20, f"{n_run} commands were found: the pages have more"
    print(f"{n_run} commands ran, {n_left} were left out")


main()
