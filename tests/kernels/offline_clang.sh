#!/usr/bin/env bash
# Every kernel passes an offline OpenCL C 1.2 compile, no device needed: with all features on (every warning an error),
# with none, and with each bit alone (where code that is switched off leaves unused names behind).
set -u
clang=$1 kernels=$2
flags=(-cl-std=CL1.2 -Xclang -finclude-default-header -target spir64 -fsyntax-only -Wall -Wextra -Wundef -Werror
       "-I$kernels" -x cl)
bits=$(sed -nE 's/^#define KDRAY_FEATURE_[A-Z]+ (0x[0-9a-f]+)u.*/\1/p' "$kernels/layout/features.h")
failed=0
for file in "$kernels"/*/*.cl; do
  "$clang" "${flags[@]}" "$file" || failed=1
  for bit in 0x0 $bits; do
    "$clang" "${flags[@]}" -Wno-unused "-Wno-unused-parameter" "-DKDRAY_FEATURES=${bit}u" "$file" || failed=1
  done
done
exit $failed
