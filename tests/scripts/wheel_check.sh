#!/usr/bin/env bash
# What    The Python package's wheels in a bare Debian root that has no driver and no compiler: wheel_check.sh FOLDER RELEASE,
#         the folder with kdray's and kdray_pocl's (scripts/wheel). They are installed, used, and uninstalled; the first hit and
#         the first picture are timed.
# Shape   mmdebstrap makes the root from the sources that this machine's apt has; what the wheel needs is downloaded before,
#         so that the root needs no network.
# Errors  Status 1 at the first step that fails; 77 (skipped) where a root can't be made.
set -euo pipefail
wheels=$(realpath "$1") suite=${2:-bookworm}
ls "$wheels"/kdray-*.whl "$wheels"/kdray_pocl-*.whl >/dev/null 2>&1 ||
  { echo "the wheels are not in $1: run scripts/wheel and scripts/wheel --pocl first"; exit 1; }
scenes=$(realpath "$(dirname "$0")/../../scenes")
# shellcheck source=tests/scripts/bare_root.sh
source "$(dirname "${BASH_SOURCE[0]}")/bare_root.sh"

step() { printf '\n== %s\n' "$*"; }
in_root() { chroot "$root" env -i PATH=/venv/bin:/usr/bin:/bin HOME=/home LANG=C.UTF-8 "$@"; }

step "a bare root, with Python alone"
make_root "$suite" --include=python3-venv
mkdir -p "$root/wheels" "$root/home"
python=$(in_root python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])')
echo "Python $python"

step "the wheel and what it needs"
python3 -m pip download -q --only-binary :all: --python-version "$python" --no-deps -d "$root/wheels" numpy
cp "$wheels"/kdray{,_pocl}-*.whl "$root/wheels"
du -ah --apparent-size "$root/wheels" | sort -k 2
in_root python3 -m venv /venv
in_root pip install -q --no-index --find-links /wheels kdray

step "without a driver"
status=0
in_root kdray devices || status=$?
[ "$status" -eq 3 ] || { echo "without a driver kdray ends with status $status, not 3"; exit 1; }

step "a first hit, with PoCL from its wheel"
in_root pip install -q --no-index --find-links /wheels 'kdray[pocl]'
cat >"$root/home/first_hit.py" <<'END'
import importlib.metadata

import kdray
import numpy as np

assert kdray.__version__ == importlib.metadata.version("kdray")
scene = kdray.Scene()
scene.add_mesh(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float), np.array([[0, 1, 2]]))
hits = scene.closest_hit(np.array([[0.25, 0.25, 1.0]]), np.array([[0.0, 0.0, -1.0]]))
assert hits.t.tolist() == [1.0], hits.t
END
time in_root python3 /home/first_hit.py
echo "once more"
time in_root python3 /home/first_hit.py

step "a first picture"
cp "$scenes/balls.nff" "$root/home"
time in_root kdray render /home/balls.nff -o /home/balls.png
[ "$(head -c 4 "$root/home/balls.png" | tail -c 3)" = PNG ] || { echo "there is no picture"; exit 1; }

step "removal"
in_root pip uninstall -q -y kdray kdray-pocl numpy
rm -r "${root:?}/wheels" "${root:?}/home"
left=$(in_root find / -xdev -path /proc -prune -o -iname '*kdray*' -print)
[ -z "$left" ] || { echo "the wheel has left $left"; exit 1; }
echo "the wheel is installed, used and removed"
