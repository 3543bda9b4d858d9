# shellcheck shell=bash
# What    A bare root of a Debian release, sourced by what tries things in one: make_root RELEASE [mmdebstrap's options] fills
#         the folder $root, in $work; both are removed when the script ends.
# Shape   mmdebstrap makes it from the sources that this machine's apt has.
# Errors  Ends the script with status 77 (skipped) where no root can be made.
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

make_root() {
  local suite=$1
  shift
  mmdebstrap -q --variant=apt "$@" "$suite" "$root"
  cp /etc/resolv.conf "$root/etc/"
  for place in proc sys dev; do mount --rbind --make-rslave "/$place" "$root/$place"; done
}
