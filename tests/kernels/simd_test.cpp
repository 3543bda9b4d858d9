// The operations of common/simd.clh, all forms, against answers made on the host lane by lane: the hard
// values of the self-test at start, and random bits under every mask of 16 lanes.
#include <gtest/gtest.h>

#include <random>

#include "device/opencl/context.h"
#include "device/opencl/opencl_error.h"
#include "device/opencl/simd.h"
#include "support/device.h"

namespace kdray {
namespace {

using device::Simd;
using layout::SimdAnswers;
using layout::SimdCase;

constexpr std::uint32_t kMasks = 1u << 16;

// Any bits but those of subnormal numbers, which a device may take for 0.
std::uint32_t random_bits(std::mt19937& random) {
  const std::uint32_t bits = static_cast<std::uint32_t>(random());
  return (bits & 0x7f800000u) == 0 ? bits & 0x80000000u : bits;
}

// In one case of four b is a but for a few lanes, so that equal numbers are no rarity.
SimdCase random_case(std::mt19937& random, std::uint32_t mask) {
  SimdCase c{};
  c.mask = mask;
  const bool alike = random() % 4 == 0;
  for (int i = 0; i < 16; ++i) {
    c.a[i] = random_bits(random);
    c.b[i] = alike && random() % 4 != 0 ? c.a[i] : random_bits(random);
    c.index[i] = static_cast<std::uint32_t>(random());
  }
  return c;
}

class SimdFormsTest : public test::EachDevice {
 protected:
  // The answers of the device, with the program built once for all cases.
  void expect_right(Simd form) {
    const device::Context context(GetParam(), 1);
    const std::string why_not = device::why_not(form, device::choose_device(GetParam()), context.opened());
    if (!why_not.empty()) GTEST_SKIP() << why_not;
    const cl::Program program =
        context.build("common/simd_test.cl", "-cl-std=CL1.2 " + device::build_option(form));
    expect_right_on(context, program, device::known_cases());
    const unsigned seed = 31;
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    for (std::uint32_t mask = 0; mask < kMasks;) {
      std::vector<SimdCase> cases;
      for (int i = 0; i < 4096; ++i) cases.push_back(random_case(random, mask++));
      expect_right_on(context, program, cases);
    }
  }

  void expect_right_on(const device::Context& context, const cl::Program& program,
                       const std::vector<SimdCase>& cases) {
    const std::vector<SimdAnswers> answers = device::checked("testing vectors", [&] {
      device::Kernel<kernels::SimdTest> kernel(program);
      return device::run_simd_test(context.opened(), kernel, cases);
    });
    ASSERT_EQ(device::first_difference(cases, answers), "") << "first mask " << cases.front().mask;
  }
};

TEST_P(SimdFormsTest, PortableFormGivesTheAnswersOfTheHost) {
  expect_right(Simd::portable);
}

TEST_P(SimdFormsTest, Avx2FormGivesTheAnswersOfTheHost) {
  expect_right(Simd::avx2);
}

TEST_P(SimdFormsTest, Avx512FormGivesTheAnswersOfTheHost) {
  expect_right(Simd::avx512);
}

KDRAY_FOR_EACH_DEVICE(SimdFormsTest);

}  // namespace
}  // namespace kdray
