#!/usr/bin/env bash
# Every kernel passes an offline OpenCL C 1.2 compile, no device needed: with all features on (every warning an error), for
# each traversal where there is a choice; with none, and with each bit alone (where code that is switched off leaves
# unused names behind; bits that leave the same text are compiled once). Kernels with explicit vectors pass for x86-64 with
# AVX-512 too, in all forms of common/simd.clh, down to LLVM's code before it is optimized: whether the target has a builtin is not asked earlier. There
# the automatic walk stands for packets and batches, whose code it has. In double (KDRAY_PRECISION=64) the kernels of the binary
# walk pass: not odprt's, nor those of the wide form alone, nor the test of float's vectors.
# Every header passes by itself, but for those that need what their includer defines: a form's masks, or its RaySource.
set -u
clang=$1 kernels=$2
common="-cl-std=CL1.2 -Xclang -finclude-default-header -Wall -Wextra -Wundef -Werror -I$kernels -x cl"
plain="-target spir64 -fsyntax-only $common"
x86="-target x86_64-linux-gnu -march=icelake-server -c -emit-llvm -Xclang -disable-llvm-passes -o /dev/null $common"
bits=$(sed -nE 's/^#define KDRAY_(FEATURE|KEEP)_[A-Z]+ (0x[0-9a-f]+)u.*/\2/p' "$kernels/layout/rules.h")
for bit in $(sed -nE 's/.*KDRAY_FEATURE\(([0-9]+)\).*/\1/p' "$kernels/layout/features.h"); do
  bits+=" $(printf '0x%x' $((1 << bit)))"
done
for kind in $(sed -nE 's/^#define KDRAY_KIND_[A-Z]+ ([0-9]+)u$/\1/p' "$kernels/layout/kinds.h"); do
  bits+=" $(printf '0x%x' $((1 << (16 + kind))))"
done
# A scene of doubles: triangles alone, and the filter.
filter=$(printf '0x%x' $((1 << 16 | 1 << $(sed -nE 's/.*FEATURE_FILTER KDRAY_FEATURE\(([0-9]+)\).*/\1/p' "$kernels/layout/features.h"))))
forms=$(sed -nE 's/^#define KDRAY_SIMD_[A-Z0-9]+ ([0-9]+).*/\1/p' "$kernels/layout/simd.h")
walks=$(sed -nE 's/^#define KDRAY_TRAVERSAL_[A-Z]+ ([0-9]+)$/\1/p' "$kernels/layout/traversal.h")
in_automatic=" $(sed -nE 's/^#define KDRAY_TRAVERSAL_(PACKET|BATCH) ([0-9]+)$/\2/p' "$kernels/layout/traversal.h" | paste -sd' ') "
# Prints a checksum of the file with this bit alone, in which the bit itself doesn't count.
text_with() {
  "$clang" -target spir64 -E -P $common -DKDRAY_TRAVERSAL=0 "-DKDRAY_FEATURES=$2" "$1" | sed "s/\b$2\b/BIT/g" | cksum
}
compiles() {
  for file in "$kernels"/*/*.cl "$kernels"/*/*/*.cl; do
    text=$("$clang" -target spir64 -E $common "$file")
    choices=1
    [[ $text == *layout/traversal.h* ]] && choices=$walks
    declare -A seen=()
    for bit in 0x0 $bits; do
      key=$(text_with "$file" "${bit}u")
      [[ -v seen[$key] ]] && continue
      seen[$key]=$bit
      echo "$plain -Wno-unused -Wno-unused-parameter -DKDRAY_TRAVERSAL=0 -DKDRAY_FEATURES=${bit}u $file"
    done
    if [[ $file == */traverse/query.cl || $file == */traverse/collect.cl ]]; then
      for walk in $choices; do
        echo "$plain -Wno-unused-parameter -DKDRAY_TRAVERSAL=$walk -DKDRAY_FEATURES=${filter}u $file"
        echo "$x86 -Wno-unused-parameter -DKDRAY_TRAVERSAL=$walk -DKDRAY_FEATURES=${filter}u $file"
      done
    fi
    for walk in $choices; do
      echo "$plain -DKDRAY_TRAVERSAL=$walk $file"
      [[ $text == *common/simd.clh* && $in_automatic != *" $walk "* ]] || continue
      for form in $forms; do echo "$x86 -DKDRAY_TRAVERSAL=$walk -DKDRAY_SIMD=$form $file"; done
    done
    if [[ $text == *common/precise.clh* ]]; then  # decides in doubles, or in floats where there are none
      echo "$plain -DKDRAY_PRECISE=32 $file"
      echo "$plain -DKDRAY_PRECISE=64 $file"
      continue
    fi
    [[ $file == */odprt/* || $file == */simd_test.cl ]] && continue
    double="-DKDRAY_PRECISION=64 $file"
    echo "$plain $double"
    echo "$plain -Wno-unused -Wno-unused-parameter -DKDRAY_FEATURES=0x0u $double"
    echo "$x86 $double"
  done
}
headers() {
  find "$kernels" \( -name '*.clh' -o -path '*/layout/*.h' \) -printf '%P\n' |
    grep -vE '^(common/simd_(portable|avx2|avx512)|traverse/(batch|learn|packet|ray_groups|walk))\.clh$' |
    while read -r header; do
      odprt=0
      [[ $header == odprt/* ]] && odprt=1
      echo "$plain -Wno-unused -DKDRAY_TRAVERSAL=0 -DKDRAY_ODPRT=$odprt $kernels/$header"
    done
}
{ compiles; headers; } | xargs -P "$(nproc)" -L 1 "$clang"
