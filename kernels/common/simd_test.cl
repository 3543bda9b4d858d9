// What    Every operation of simd.clh on given cases: the probe build and self-test of
//         host/device/opencl/simd.h, and the test of all forms.
// Shape   One work-item goes through all cases: the kernels that use simd.clh run one work-item to a vector,
//         too. For a compiler that says that its target lacks the form's instructions there is no kernel
//         here, rather than a failed build, about which PoCL would print a line.
#include "layout/simd.h"
#ifndef KDRAY_SIMD
#define KDRAY_SIMD KDRAY_SIMD_PORTABLE
#endif
#if KDRAY_SIMD == KDRAY_SIMD_AVX512
#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__) && defined(__AVX512BW__)
#define KDRAY_TARGET_HAS_IT 1
#endif
#elif KDRAY_SIMD == KDRAY_SIMD_AVX2
#if defined(__AVX2__) && defined(__FMA__)
#define KDRAY_TARGET_HAS_IT 1
#endif
#else
#define KDRAY_TARGET_HAS_IT 1
#endif

#ifdef KDRAY_TARGET_HAS_IT
#include "common/simd.clh"
#include "layout/arguments.h"
#include "layout/simd_test.layout.h"

static inline void answer_scalars(__global const SimdCase* in, __global SimdAnswers* out) {
  out->lanes_below = lanes_below(in->index[0] & 63u);
  out->count_lanes = count_lanes(in->mask);
  out->first_lane = first_lane(in->mask | 0x10000u);
  out->pad = 0;
}

static inline void answer16(__global const SimdCase* in, __global SimdAnswers* out) {
  const uint16 ua = vload16(0, in->a), ub = vload16(0, in->b), index = vload16(0, in->index) & 15u;
  const float16 a = as_float16(ua), b = as_float16(ub), zero = (float16)(0.0f);
  const mask16 mask = in->mask & 0xffffu;
  out->less16 = less16(a, b);
  out->less_equal16 = less_equal16(a, b);
  out->equal16 = equal16(a, b);
  out->equalu16 = equalu16(ua, ub);
  out->negative16 = negative16(a);
  vstore16(as_uint16(select16(mask, a, b)), 0, out->select16);
  vstore16(selectu16(mask, ua, ub), 0, out->selectu16);
  // What lies behind the packed lanes is unspecified.
  pack16(mask, a, (__global float*)out->pack16);
  for (u32 i = count_lanes(mask); i < 16; ++i) out->pack16[i] = 0;
  prefetch_line(in->b);
  vstore16(as_uint16(gather16((__global const float*)in->b, index)), 0, out->gather16);
  vstore16(gatheru16(in->b, index), 0, out->gatheru16);
  const float16 numbers = select16(equal16(a, a), a, zero);
  out->smallest16 = as_uint(smallest16(numbers) + 0.0f);
  out->largest16 = as_uint(largest16(numbers) + 0.0f);
  vstore16(nearest_long16(select16(less16(fabs(a), (float16)(0x1p62f)), a, zero)), 0, out->nearest_long16);
}

static inline void answer8(__global const SimdCase* in, __global SimdAnswers* out) {
  const uint8 ua = vload8(0, in->a), ub = vload8(0, in->b), index = vload8(0, in->index);
  const float8 a = as_float8(ua), b = as_float8(ub);
  const mask8 mask = in->mask & 0xffu;
  out->less8 = less8(a, b);
  out->less_equal8 = less_equal8(a, b);
  out->equal8 = equal8(a, b);
  out->less4 = less4(a.lo, b.lo);
  out->less_equal4 = less_equal4(a.lo, b.lo);
  float packed[8];
  u32 packedu[8];
  pack8(mask, a, packed);
  packu8(mask, ua, packedu);
  const int8 stays = (int8)(0, 1, 2, 3, 4, 5, 6, 7) < (int8)((int)count_lanes(mask));
  vstore8(stays ? as_uint8(vload8(0, packed)) : (uint8)(0), 0, out->pack8);
  vstore8(stays ? vload8(0, packedu) : (uint8)(0), 0, out->packu8);
  vstore8(as_uint8(permute8(a, index)), 0, out->permute8);
  vstore8(permuteu8(ua, index), 0, out->permuteu8);
}

__kernel void simd_test(KDRAY_PARAMETERS(KDRAY_SIMD_TEST_ARGUMENTS)) {
  for (u32 i = 0; i < n; ++i) {
    answer_scalars(in_cases + i, out_answers + i);
    answer16(in_cases + i, out_answers + i);
    answer8(in_cases + i, out_answers + i);
  }
}
#endif
