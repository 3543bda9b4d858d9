#!/usr/bin/env bash
# What    A clone of this folder's last commit in a bare root of a Debian release, as a stranger has it: clone_check.sh trixie
#         runs scripts/test there, clone_check.sh trixie scripts/deb another command. What is missing its own scripts install.
# Errors  The command's status; 1 where the root isn't made; 77 (skipped) where none can be made.
set -euo pipefail
# shellcheck source=scripts/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/../../scripts/lib.sh"
suite=$1
shift
command -v mmdebstrap >/dev/null || try_to_install mmdebstrap
[ $# -gt 0 ] || set -- scripts/test
# shellcheck source=tests/scripts/bare_root.sh
source "$(dirname "${BASH_SOURCE[0]}")/bare_root.sh"

in_root() {
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"
}

make_root "$suite" --include=ca-certificates,git
git clone -q "$kdray_root" "$root/kdray"
in_root sh -c 'cd /kdray && git log -1 --format="commit %H" && exec "$@"' sh "$@"
