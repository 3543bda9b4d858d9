# shellcheck shell=bash
# What    Shared by scripts/bundle and scripts/wheel: copies this machine's libraries, with what they load and their licences,
#         into $folder; among them PoCL, for machines without any driver.
# Shape   Sourced after scripts/lib.sh.
# Errors  Status 1 where there is no PoCL or no linker.
# shellcheck disable=SC2154  # $folder and $kdray_root are the script's

# What these files load, and what that loads in turn, without glibc and what is in the folder already.
libraries_of() {
  ldd "$@" | awk '$2 == "=>" && $3 ~ /^\// {print $3}' | sort -u |
    grep -vE '/(ld-linux.*|lib(c|m|mvec|dl|pthread|rt|resolv|util|anl))\.so' |
    while read -r file; do
      [ -e "$folder/lib/${file##*/}" ] || [ -e "$folder/lib/gcc/${file##*/}" ] || echo "$file"
    done
}

copy_licence_of() {
  local file package
  file=$(realpath "$1")
  package=$(dpkg-query -S "$file" "${file#/usr}" 2>/dev/null | head -n 1 | cut -d: -f1) || true
  [ -n "$package" ] || return 0
  cp -L "/usr/share/doc/$package/copyright" "$folder/licences/$package"
  # Debian's files name the usual licences by where Debian has their texts.
  grep -ohE '/usr/share/common-licenses/[A-Za-z0-9.-]*[A-Za-z0-9]' "$folder/licences/$package" | sort -u | while read -r text; do
    [ ! -f "$text" ] || cp -L "$text" "$folder/licences/"
  done || true
}

# copy_libraries FOLDER FILE...
copy_libraries() {
  local to=$1 file
  shift
  mkdir -p "$to" "$folder/licences"
  for file in "$@"; do
    install -m 644 "$file" "$to/${file##*/}"
    copy_licence_of "$file"
  done
}

# PoCL finds its devices in pocl/ beside its library, and what kernels are built with in ../../share/pocl. It links kernels by
# `ld`, which is GNU gold here.
copy_pocl() {
  local library gold libraries
  library=$(ldconfig -p | awk '/libpocl\.so\.2 / && !found++ {print $NF}')
  gold=$(command -v ld.gold) || gold=
  if [ -z "$library" ] || [ -z "$gold" ]; then say "there is no PoCL, or no ld.gold (pocl-opencl-icd, binutils, from Debian 13 on binutils-gold)"; exit 1; fi
  mapfile -t libraries < <(echo "$library"; libraries_of "$library" "$gold")
  copy_libraries "$folder/lib/pocl" "${libraries[@]}"
  copy_libraries "$folder/lib/pocl/pocl" "$(dirname "$library")"/pocl/libpocl-devices-*.so
  mkdir -p "$folder/share" "$folder/linker"
  cp -rL /usr/share/pocl "$folder/share/"
  install "$kdray_root/python/pocl/ld" "$folder/linker/ld"
  install "$gold" "$folder/linker/gold"
  copy_licence_of "$gold"
}
