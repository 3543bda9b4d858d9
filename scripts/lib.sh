# shellcheck shell=bash
# What    Shared by scripts/run and scripts/test: installs what is missing, configures and builds a preset.
# Shape   Sourced after `set -euo pipefail`. All output goes to stderr: stdout belongs to the program.
# Errors  A failed step prints its log and ends the script with status 1.

kdray_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

say() { printf 'kdray: %s\n' "$*" >&2; }

# The packages of scripts/dependencies before [optional].
required_packages() {
  sed -e '/^\[optional\]/,$d' -e 's/#.*//' "$kdray_root/scripts/dependencies" | awk 'NF {print $1}'
}

missing_packages() {
  local package
  for package in $(required_packages); do
    dpkg-query -W -f '${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || echo "$package"
  done
}

# Two builds in one folder would spoil each other: the second waits until the first one's (sub)shell has ended.
one_at_a_time() {
  mkdir -p "$kdray_root/build"
  exec 9>"$kdray_root/build/lock"
  flock -n 9 && return
  say "waiting for another build of this folder"
  flock 9
}

# Runs a command with its output in a log; shows the log when it fails, and a sign of life when it takes long.
logged() {
  local what=$1 log=$2 status=0 start=$SECONDS pid
  shift 2
  mkdir -p "$(dirname "$log")"
  "$@" >"$log" 2>&1 </dev/null &
  pid=$!
  local ticks=0
  while kill -0 "$pid" 2>/dev/null; do
    sleep 0.05
    ticks=$((ticks + 1))
    if [ "$ticks" -eq 20 ]; then say "$what (log: ${log#"$kdray_root"/})"; fi
    if [ "$ticks" -gt 20 ] && [ $((ticks % 300)) -eq 0 ]; then
      say "  $((SECONDS - start)) s  $(tail -n 1 "$log" | cut -c1-100)"
    fi
  done
  wait "$pid" || status=$?
  if [ "$status" -ne 0 ]; then
    tail -n 60 "$log" >&2
    say "$what failed (whole log: $log)"
    return 1
  fi
}

install_packages() {
  local sudo=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { say "not root and no sudo; as root: apt-get install $*"; exit 1; }
    # With nobody there to type a password, fail at once instead of waiting for one.
    if [ -t 0 ]; then sudo=(sudo); else sudo=(sudo -n); fi
    "${sudo[@]}" true || { say "sudo was refused; as root: apt-get install $*"; exit 1; }
  fi
  say "installing $*"
  local apt=("${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=120)
  # The lists may be old or not there at all: fetch them, and only once.
  logged "fetching the package lists" "$kdray_root/build/log/apt-update.log" "${apt[@]}" update || exit 1
  logged "installing packages" "$kdray_root/build/log/apt-install.log" \
    "${apt[@]}" install -y --no-install-recommends "$@" || exit 1
}

# For what is used where it can be had: installs the packages where that asks nobody for a password.
try_to_install() {
  if [ "$(id -u)" -eq 0 ] && command -v apt-get >/dev/null; then (install_packages "$@") || true; fi
}

# Debian's python3 comes without headers, and without what makes virtual environments.
complete_python() {
  python3 -c 'import ensurepip, os, sysconfig; os.stat(sysconfig.get_path("include") + "/Python.h")' 2>/dev/null ||
    try_to_install python3 python3-dev python3-venv
}

# python_packages WHAT FOLDER LOGS PACKAGE==VERSION...: a virtual environment with packages from PyPI.
python_packages() {
  local what=$1 folder=$2 logs=$3
  shift 3
  rm -rf "$folder"
  python3 -c 'import ensurepip' 2>/dev/null || complete_python
  logged "fetching $what" "$logs/venv.log" python3 -m venv "$folder" &&
    logged "fetching $what" "$logs/pip.log" timeout 300 "$folder/bin/pip" install --no-cache-dir "$@"
}

# Changes when the list of packages or what dpkg has installed changes.
packages_key() {
  cksum <"$kdray_root/scripts/dependencies"
  stat -c %Y /var/lib/dpkg/status 2>/dev/null || true
}

# Asking dpkg takes a third of a second, so that everything was found is kept in a stamp.
ensure_packages() {
  local stamp="$kdray_root/build/packages.stamp" key missing
  key=$(packages_key)
  if [ -f "$stamp" ] && [ "$(cat "$stamp")" = "$key" ]; then return; fi
  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    if command -v cmake >/dev/null && command -v ninja >/dev/null; then return; fi  # cmake will name what is missing
    say "this is no Debian: install cmake, ninja and what these Debian packages hold, then run this again:"
    required_packages | paste -sd' ' | fold -s -w 100 >&2
    exit 1
  fi
  missing=$(missing_packages)
  if [ -n "$missing" ]; then
    # shellcheck disable=SC2086  # one word per package
    install_packages $missing
    missing=$(missing_packages)
    [ -z "$missing" ] || { say "still not installed: $missing"; exit 1; }
  fi
  packages_key >"$stamp"
}

# configure PRESET [cmake arguments]: once; afterwards Ninja runs CMake itself when a CMakeLists.txt has changed.
configure() {
  local preset=$1
  shift
  if [ -f "$kdray_root/build/$preset/build.ninja" ] && [ $# -eq 0 ]; then return; fi
  local arguments=(--preset "$preset" "$@")
  if command -v ccache >/dev/null; then arguments+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
  cd "$kdray_root" || exit 1
  logged "configuring" "$kdray_root/build/log/configure-$preset.log" cmake "${arguments[@]}" || exit 1
}

# build PRESET [targets]
build() {
  local preset=$1 targets=()
  shift
  if [ $# -gt 0 ]; then targets=(--target "$@"); fi
  logged "building" "$kdray_root/build/log/build-$preset.log" \
    cmake --build "$kdray_root/build/$preset" "${targets[@]}" || exit 1
}
