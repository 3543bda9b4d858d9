// What    Which form of common/simd.clh a device's kernels are built with: x86 builtins (AVX-512, else AVX2)
//         or portable OpenCL C.
// Shape   Forms are tried from the best on, per device and once per process. A form has to pass three tests:
//         the processor's features, a probe build, and a self-test of every operation against answers made on
//         the host (simd_answers.cpp). A device's name is never asked. A compiler that has lost a builtin, or
//         got one wrong, costs the form that needs it and no other. KDRAY_SIMD=portable, avx2 or avx512 in
//         the environment asks for a form; it has to pass all the same.
// Errors  ErrorCode::no_device: no form passes, or the one asked for doesn't. ErrorCode::usage: KDRAY_SIMD is
//         none of them.
#pragma once

#include <string>
#include <vector>

#include "device/opencl/kernel.h"
#include "device/opencl/platform.h"
#include "device/opencl/program.h"
#include "layout/simd.h"
#include "layout/simd_test.layout.h"

namespace kdray::device {

struct OpenDevice;

enum class Simd {
  portable = KDRAY_SIMD_PORTABLE,
  avx2 = KDRAY_SIMD_AVX2,
  avx512 = KDRAY_SIMD_AVX512,
};

// A device's form, and the better ones that it can't have.
struct SimdChoice {
  struct Refusal {
    Simd form;
    std::string why;
  };
  Simd form = Simd::portable;
  std::vector<Refusal> refused = {};

  // "x86 AVX-512: the processor has no AVX-512 (F, VL, DQ and BW)", or empty.
  std::string refused_in_words() const;
};

const char* in_words(Simd form);      // "portable", "x86 AVX2", "x86 AVX-512"
std::string build_option(Simd form);  // "-DKDRAY_SIMD=0"

// Returns the form for this device's kernels. It is remembered, since finding out takes a build and a launch.
SimdChoice choose_simd(const FoundDevice& found, const OpenDevice& opened, const Builds& builds = {});

// Does the same, tried anew.
SimdChoice probe_simd(const FoundDevice& found, const OpenDevice& opened, const Builds& builds = {});

// Returns why this device can't have the form; an empty text when it can.
std::string why_not(Simd form, const FoundDevice& found, const OpenDevice& opened, const Builds& builds = {});

// Runs the kernel of common/simd_test.cl on the device and returns its answers to the cases. Throws
// cl::Error.
std::vector<layout::SimdAnswers> run_simd_test(const OpenDevice& opened, Kernel<kernels::SimdTest>& kernel,
                                               const std::vector<layout::SimdCase>& cases);

// Returns the answers that every form must give, made on the host one lane at a time.
layout::SimdAnswers expected_answers(const layout::SimdCase& given);

// Returns the self-test's cases: every pair of NaN, infinities, zeros of both signs, limits and common
// numbers, in every lane, and every mask of 8 lanes.
std::vector<layout::SimdCase> known_cases();

// Returns the first operation whose answer differs by a bit ("pack16 of case 3"); an empty text when none
// does.
std::string first_difference(const std::vector<layout::SimdCase>& cases,
                             const std::vector<layout::SimdAnswers>& answers);

}  // namespace kdray::device
