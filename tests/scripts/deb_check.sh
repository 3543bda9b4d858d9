#!/usr/bin/env bash
# What    The packages in a bare Debian root: deb_check.sh FOLDER RELEASE; the folder holds them (scripts/deb). They are installed,
#         used by debian/tests, upgraded to a version that differs in its number alone, and removed; nothing of theirs may stay.
# Errors  Status 1 at the first step that fails; 77 (skipped) where a root can't be made.
set -euo pipefail
packages=$(realpath "$1") suite=${2:-bookworm}
ls "$packages"/*.deb >/dev/null 2>&1 || { echo "there are no packages in $1: run scripts/deb first"; exit 1; }
# shellcheck source=tests/scripts/bare_root.sh
source "$(dirname "${BASH_SOURCE[0]}")/bare_root.sh"

step() { printf '\n== %s\n' "$*"; }
in_root() {
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"
}
install() { in_root apt-get install -qq -y --no-install-recommends "$@" >"$work/apt.log" 2>&1 || { tail -n 30 "$work/apt.log"; exit 1; }; }

# The packages once more, with a version after theirs.
make_upgrades() {
  local deb
  mkdir -p "$root/upgrades"
  for deb in "$root"/packages/*.deb; do
    dpkg-deb -R "$deb" "$work/unpacked"
    sed -i -E 's/^(Version: .*)/\1+1/; s/(\(= [^)]*)\)/\1+1)/g' "$work/unpacked/DEBIAN/control"
    dpkg-deb --root-owner-group -b "$work/unpacked" "$root/upgrades" >/dev/null
    rm -r "$work/unpacked"
  done
}

run_tests() {
  local test
  for test in picture ranks embed python; do
    echo "-- debian/tests/$test"
    in_root sh -c "rm -rf /tmp/$test && mkdir -p /tmp/$test"
    in_root env AUTOPKGTEST_TMP="/tmp/$test" "/tests/$test" >"$work/test.log" 2>&1 || { tail -n 30 "$work/test.log"; exit 1; }
    tail -n 3 "$work/test.log"
  done
}

step "a bare root"
make_root "$suite"
cp -R "$(dirname "$0")/../../debian/tests" "$root/tests"
mkdir "$root/packages"
find "$packages" -name '*.deb' ! -name '*-dbgsym_*' -exec cp {} "$root/packages" \;
in_root apt-get -qq update >"$work/apt.log" 2>&1 || { tail -n 30 "$work/apt.log"; exit 1; }
in_root find / -xdev -path /proc -prune -o -path '/packages' -prune -o -iname '*kdray*' -print >"$work/before"

step "kdray alone, without a driver"
install "/packages/$(basename "$root"/packages/kdray_*.deb)"
du -sh --apparent-size "$root/usr/bin/kdray" | cut -f1
status=0
in_root kdray render /usr/share/kdray/scenes/balls.nff -o /tmp/balls.png || status=$?
[ "$status" -eq 3 ] || { echo "without a driver kdray ends with status $status, not 3"; exit 1; }

step "a first picture"
install pocl-opencl-icd
time in_root kdray render /usr/share/kdray/scenes/balls.nff -o /tmp/balls.png

step "all packages, and their tests"
in_root sh -c 'cd /packages && ls *.deb'
# shellcheck disable=SC2046  # names without blanks
install $(cd "$root" && printf '/%s ' packages/*.deb) cmake g++ make
run_tests

step "upgrade"
make_upgrades
in_root sh -c 'dpkg -i /upgrades/*.deb' >"$work/apt.log" 2>&1 || { tail -n 30 "$work/apt.log"; exit 1; }
in_root dpkg -l '*kdray*' | awk '/^ii/ {print $2, $3}'
run_tests

step "removal"
# shellcheck disable=SC2046  # names without blanks
in_root apt-get purge -qq -y $(in_root dpkg -l '*kdray*' | awk '/^ii/ {print $2}') >"$work/apt.log" 2>&1
rm -r "$root/packages" "$root/upgrades" "$root/tests"
find "$root/tmp" -mindepth 1 -delete # the user's home here, with its cache
in_root find / -xdev -path /proc -prune -o -iname '*kdray*' -print >"$work/after"
diff "$work/before" "$work/after" || { echo "the packages have left something"; exit 1; }
echo "the packages are installed, used, upgraded and removed"
