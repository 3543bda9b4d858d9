// What    One case of common/simd_test.cl and its answers: all operations of common/simd.clh on two vectors
//         and a mask.
// Shape   An answer bears the name of its operation. Vectors are kept by their bits, so that NaN and -0 can
//         be compared.
#ifndef KDRAY_LAYOUT_SIMD_TEST_H
#define KDRAY_LAYOUT_SIMD_TEST_H
#include "layout/base.layout.h"

KDRAY_LAYOUT_BEGIN
typedef struct SimdCase {
  u32 a[16], b[16];  // floats by their bits
  u32 index[16];     // any numbers: a permutation takes the low 3 bits of each, the test's gathers the low 4
  u32 mask;
  u32 pad[15];
} SimdCase;
KDRAY_ASSERT_SIZE(SimdCase, 256)

typedef struct SimdAnswers {
  u32 lanes_below;                                          // of the low 6 bits of index[0]
  u32 count_lanes;                                          // of mask
  u32 first_lane;                                           // of mask with bit 16 set
  u32 less16, less_equal16, equal16, equalu16, negative16;  // negative16: of a
  u32 less8, less_equal8, equal8, less4, less_equal4;
  u32 smallest16, largest16;  // of a with 0 for NaN, and + 0 for -0
  u32 pad;
  u32 select16[16], selectu16[16];  // a where mask is set, else b
  u32 pack16[16];                   // of a
  u32 gather16[16], gatheru16[16];  // from b
  u32 pack8[8], packu8[8];          // of a's lower half
  u32 permute8[8], permuteu8[8];    // of a's lower half
  i64 nearest_long16[16];           // of a with 0 for what is not below 2^62
} SimdAnswers;
KDRAY_ASSERT_SIZE(SimdAnswers, 640)
KDRAY_LAYOUT_END
#endif
