// What    Whether a device computes rightly: it traces rays of known hits through a small scene, by the
//         program that queries use, and every bit is compared.
// Shape   The scene is a slanted quad behind a sphere and a cone, seen through a grid of rays; some hit each,
//         some hit nothing. The answers are those of the kernels as they are meant to be:
//         tests/probe/selftest holds them against closed forms in double.
//         The test takes a program of its own, so that the outcome is kept beside built programs as a
//         verdict: a device that has passed with this driver and these kernels is not tested again by other
//         processes. The vector operations are tested at every start (device/opencl/simd.h).
//         A device that is no CPU may round otherwise (division, the order of a builtin's steps): there hits
//         may be off by 1e-5.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/hash.h"
#include "device/opencl/context.h"
#include "device/opencl/verdicts.h"
#include "kdray/ray.h"
#include "scene/model/scene.h"

namespace kdray::selftest {

scene::Scene known_scene();
std::vector<Ray> known_rays();

// A hit, its floats as bits.
struct Answer {
  std::uint32_t t;
  std::int32_t primitive;
  std::uint32_t u, v;
  bool operator==(const Answer&) const = default;
};

std::span<const Answer> known_answers();

// Tests the device anew, whatever the outcome was before, and returns what is wrong, in words; empty:
// nothing.
std::string fault_of(const device::Context& context);

// Throws ErrorCode::no_device, naming device and fault, unless the device passes, or has passed before. With
// `fail` it does as if the device computed wrongly. A device that has failed before is tested anew, and the
// verdict on it stays: the caller wants that very device.
void require(const device::Context& context, bool fail = false);

// Returns the key that the verdict on a device is kept under. It is made of the device with its driver, of
// the kernels that test it, and of what the environment asks for. The device need not have been opened.
// Throws cl::Error.
Hash verdict_key(const cl::Device& device);

// Returns the verdict on a device that has passed with these vectors.
device::Verdict passed_with(device::Simd form);

// Returns what the device answers to known_rays(). The table of answers is made of this, when a change of the
// kernels is meant to change bits.
std::vector<Answer> answers_of(const device::Context& context);

// Returns what is wrong with these answers to known_rays(); empty: nothing.
std::string first_fault(const std::vector<Hit>& hits, bool exact);

}  // namespace kdray::selftest
