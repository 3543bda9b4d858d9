#!/usr/bin/env bash
# What    What scripts/bundle makes, tried in a root that has glibc, a shell with its tools, and nothing else, without network:
#         bundle_test.sh PROGRAMS, a folder with kdray and kdray-bench.
# Shape   The larger archive's PoCL first. Then, as on a machine that is lent a GPU, PoCL is what the dynamic linker knows as
#         libnvidia-opencl.so.1, while the only file in /etc/OpenCL/vendors names a library that is not there.
# Errors  Status 1 with what went wrong; 77: there is no PoCL or linker to bundle, or no such root is allowed here.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
skip() { echo "skipped: $*"; exit 77; }
fail() { echo "failed: $*"; exit 1; }
[ "$(uname -m)" = x86_64 ] || skip "the root is one for x86-64"
unshare -r -n -m true 2>/dev/null || skip "unshare is not allowed here"
ldconfig -p | grep 'libpocl\.so\.2 ' >/dev/null || skip "PoCL is not installed"
command -v ld.gold >/dev/null || skip "there is no ld.gold"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
root=$work/root
system=$root/lib/x86_64-linux-gnu
KDRAY_DATA_DIR=none scripts/bundle --with-pocl --programs "$1" --into "$work" >/dev/null 2>"$work/log" ||
  fail "scripts/bundle: $(cat "$work/log")"

needed=(awk basename bash cat cp cut dirname env grep head ls md5sum mkdir mv nproc paste readlink rm sed sh tail timeout tr xargs)
make_root() {
  local tools tool
  mkdir -p "$root"/{bin,usr,lib64,proc,dev,sys,tmp,root,etc/OpenCL/vendors} "$system"
  ln -s ../bin "$root/usr/bin"
  cp -L /lib64/ld-linux-x86-64.so.2 "$root/lib64/"
  for tool in "${needed[@]}"; do
    tools+=("$(type -P "$tool")")
    cp -L "${tools[-1]}" "$root/bin/"
  done
  ldd "${tools[@]}" | awk '$2 == "=>" {print $3}' | sort -u | xargs cp -Lt "$system"
  cp -L /lib/x86_64-linux-gnu/lib{m,dl,pthread,rt}.so.* "$system/"
}

# inside COMMAND...
inside() {
  # shellcheck disable=SC2016
  unshare -r -n -m -p -f bash -c 'cd "$0" && mount -t proc proc proc && mount --rbind /dev dev && mount --rbind /sys sys &&
    exec chroot . /bin/env -i HOME=/root PATH=/bin "$@"' "$root" "$@"
}

# The libraries of the archive that come from elsewhere, but for glibc's; and those that nothing has.
strangers() {
  # shellcheck disable=SC2016
  inside sh -c 'export LD_LIBRARY_PATH=/kdray/lib:/kdray/lib/pocl:/kdray/lib/pocl/pocl:/kdray/lib/gcc LD_TRACE_LOADED_OBJECTS=1
    for file in /kdray/bin/* /kdray/lib/pocl/pocl/* /kdray/linker/gold; do /lib64/ld-linux-x86-64.so.2 "$file"; done' |
    awk '$2 == "=>" && $3 !~ /^\/kdray\/|\/lib(c|m|dl|pthread|rt)\.so/ {print $1, $3}'
}

make_root
mv "$work"/kdray-*-pocl "$root/kdray"
[ -z "$(strangers)" ] || fail "libraries that are not the archive's: $(strangers)"

inside /kdray/gpu-check --device cpu --quick --results /ok devices pictures >"$work/out" || fail "gpu-check: $(cat "$work/out")"
[ "$(grep -c '^ok .*picture.* identical$' "$work/out")" = "$(wc -l <"$root/kdray/reference/pictures")" ] ||
  fail "pictures are not those of the CPU outside: $(cat "$work/out")"

# Another picture to compare with: one step fails, and the others run.
cp "$root/kdray/reference/tree.exr" "$root/kdray/reference/balls.exr"
status=0
inside /kdray/gpu-check --device cpu --quick --results /wrong pictures verify >"$work/out" || status=$?
grep -q '^failed .*picture-balls *differs: rmse' "$work/out" || status=2
grep -q '^ok .*verify-showcase' "$work/out" || status=2
[ $status = 1 ] || fail "gpu-check of a wrong picture: $(cat "$work/out")"
grep -q '"step": "picture-balls", "ok": false' "$root/wrong/summary.json" || fail "summary.json: $(cat "$root/wrong/summary.json")"

# As on a machine with a GPU's driver.
mkdir "$system/pocl" "$root/share"
mv "$root"/kdray/lib/pocl/pocl/* "$system/pocl/"
mv "$root/kdray/lib/pocl/libpocl.so.2" "$system/libnvidia-opencl.so.1"
mv "$root"/kdray/lib/pocl/*.so.* "$system/"
rm -r "$root/kdray/lib/pocl"
mv "$root/kdray/share/pocl" "$root/share/"
echo /nowhere/libpocl.so >"$root/etc/OpenCL/vendors/pocl.icd"
inside /kdray/kdray doctor >"$work/out" || fail "kdray doctor: $(cat "$work/out")"
grep -q '^\[ok\] *driver libnvidia-opencl.so.1 ' "$work/out" || fail "the driver is not found: $(cat "$work/out")"
inside /kdray/gpu-check --results /none pictures >"$work/out" && fail "a CPU counts as a GPU: $(cat "$work/out")"
echo passed
