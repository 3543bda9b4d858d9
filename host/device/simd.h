// What    Which form of common/simd.clh a device's kernels are built with: x86 AVX-512 builtins or portable
//         OpenCL C.
// Shape   Decided per device, once per process: by the processor's features, a probe build, and a self-test
//         of every operation against answers made on the host (device/simd_answers.h). Never by a name.
//         KDRAY_SIMD=portable or KDRAY_SIMD=x86 in the environment asks for a form; it has to pass all the
//         same.
// Errors  ErrorCode::no_device: no form passes, or the one asked for doesn't. ErrorCode::usage: KDRAY_SIMD is
//         neither.
#pragma once

#include <string>
#include <vector>

#include "device/builds.h"
#include "device/kernel.h"
#include "device/platform.h"
#include "layout/simd_test.layout.h"

namespace kdray::device {

struct Opened;

enum class Simd { portable, x86 };

const char* in_words(Simd form);      // "portable", "x86 AVX-512"
std::string build_option(Simd form);  // "-DKDRAY_SIMD_X86=0"

// The form for this device's kernels; remembered, since it takes a build and a launch to know.
Simd choose_simd(const FoundDevice& found, const Opened& opened, const Builds& builds = {});

// The same, tried anew.
Simd probe_simd(const FoundDevice& found, const Opened& opened, const Builds& builds = {});

// Why this device can't have the x86 form; empty when it can.
std::string why_no_x86(const FoundDevice& found, const Opened& opened, const Builds& builds = {});

// What the device answers to the cases, by the kernel of common/simd_test.cl. Throws cl::Error.
std::vector<layout::SimdAnswers> run_simd_test(const Opened& opened, Kernel<kernels::SimdTest>& kernel,
                                               const std::vector<layout::SimdCase>& cases);

}  // namespace kdray::device
