// What    The forms of common/simd.clh, by number: a program is built for one of them (KDRAY_SIMD).
#ifndef KDRAY_LAYOUT_SIMD_H
#define KDRAY_LAYOUT_SIMD_H

#define KDRAY_SIMD_PORTABLE 0  // plain OpenCL C
#define KDRAY_SIMD_AVX2 1      // with FMA and BMI
#define KDRAY_SIMD_AVX512 2    // F, VL, DQ and BW
#endif
