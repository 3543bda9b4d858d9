// What    Whether a device computes rightly: it traces rays of known hits through the tree, by the program
//         that queries use, and every bit is compared.
// Shape   It takes a program of its own, so that the outcome is kept beside built programs as a verdict: a
//         device that has passed with this driver and these kernels is not asked again by other processes.
//         The vector operations are tested at every start (device/simd.h).
//         A device that is no CPU may round otherwise (division, the order of a builtin's steps): there hits
//         may be off by 1e-5.
#pragma once

#include <string>
#include <vector>

#include "base/hash.h"
#include "device/opencl/context.h"
#include "device/opencl/verdicts.h"
#include "kdray/ray.h"
#include "probe/selftest/known_case.h"

namespace kdray::selftest {

// What is wrong, in words; empty when nothing is. It tests anew, whatever the outcome was before.
std::string fault_of(const device::Context& context);

// Throws ErrorCode::no_device, naming device and fault, unless the device passes, or has passed before. With
// `fail` it does as if the device computed wrongly. A device that has failed before is tested anew, and the
// verdict on it stays: whoever calls this wants that very device.
void require(const device::Context& context, bool fail = false);

// The key that the verdict on a device is kept under: of the device with its driver, of the kernels that
// test it, and of what the environment asks for. The device need not have been opened. Throws cl::Error.
Hash verdict_key(const cl::Device& device);

// The verdict on a device that has passed with these vectors.
device::Verdict passed_with(device::Simd form);

// What the device answers to known_rays(). The table of answers is made of this, when a change of the kernels
// is meant to change bits.
std::vector<Answer> answers_of(const device::Context& context);

// What is wrong with these answers to known_rays().
std::string first_fault(const std::vector<Hit>& hits, bool exact);

}  // namespace kdray::selftest
