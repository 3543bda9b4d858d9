// What    The instruction sets that Highway's files are compiled for; comes before Highway's foreach_target.
// Why     SSSE3 and AVX3_DL would add nothing here. Vectors whose length the compiler doesn't know (SVE, RVV)
//         can't be members of structs. The fallback for any machine is Highway's emulation of
//         128 bits, which it avoids with g++ before 12.3 for a fault in products of 16-bit integers (GCC bug
//         106322); there are none here.
#pragma once

#define HWY_BROKEN_EMU128 0
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
