#!/usr/bin/env bash
# What    A clone of this folder's last commit in a bare root of a Debian release, as a stranger has it: clone_check.sh trixie
#         runs scripts/test there, clone_check.sh trixie scripts/deb another command. What is missing its own scripts install.
# Shape   mmdebstrap makes the root, in a temporary folder.
# Errors  The command's status; 1 where the root isn't made; 77 (skipped) where none can be made.
set -euo pipefail
# shellcheck source=scripts/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/../../scripts/lib.sh"
suite=$1
shift
command -v mmdebstrap >/dev/null || try_to_install mmdebstrap
[ $# -gt 0 ] || set -- scripts/test
if [ "$(id -u)" -ne 0 ] || ! command -v mmdebstrap >/dev/null; then
  echo "skipped: a bare root takes mmdebstrap, and root"
  exit 77
fi
work=$(mktemp -d)
root=$work/root

leave() {
  for place in proc sys dev; do umount -l "$root/$place" 2>/dev/null || true; done
  rm -rf --one-file-system "$work"
}
trap leave EXIT

in_root() {
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"
}

mmdebstrap -q --variant=apt --include=ca-certificates,git "$suite" "$root"
git clone -q "$kdray_root" "$root/kdray"
cp /etc/resolv.conf "$root/etc/"
for place in proc sys dev; do mount --rbind --make-rslave "/$place" "$root/$place"; done
in_root sh -c 'cd /kdray && git log -1 --format="commit %H" && exec "$@"' sh "$@"
