// The highlights' power against the host's in extended precision: at most 2 ulp wherever the result is a
// normal number, 1 for a base of 1 and an exponent of 0, and nothing below.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/device.h"
#include "support/run_kernel.h"

namespace kdray {
namespace {

struct Case {
  float x, y;
};

class PowerTest : public test::EachDevice {};

constexpr const char* kSource = R"(#include "common/power.clh"
__kernel void test(__global const float2* in, __global float* out, uint n) {
  const uint i = get_global_id(0);
  if (i < n) out[i] = power((float16)(in[i].x), (float16)(in[i].y)).s3;
}
)";

std::vector<Case> cases(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Case> in;
  for (int i = 0; i < 100000; ++i) {
    in.push_back({1 - unit(random), 200 * unit(random)});                                  // highlights
    in.push_back({1 - std::pow(unit(random), 4.0f) * 0.1f, std::exp(14 * unit(random))});  // sharp ones
    in.push_back({std::exp(-87 * unit(random)), 2 * unit(random)});                        // faint ones
    in.push_back({std::ldexp(1 - unit(random) / 2, -static_cast<int>(random() % 20)), unit(random)});
    in.push_back({1e-39f * (1 - unit(random)), unit(random)});  // no normal number
  }
  return in;
}

TEST_P(PowerTest, StaysWithinTwoUlp) {
  const unsigned seed = 11;
  SCOPED_TRACE(seed);
  std::vector<Case> in = cases(seed);
  std::erase_if(in, [](const Case& c) { return !(c.x > 0 && c.x <= 1); });
  const std::vector<float> out = test::run_kernel<float>(GetParam(), kSource, in);
  double worst = 0;
  std::size_t checked = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const long double truth = std::pow(static_cast<long double>(in[i].x), static_cast<long double>(in[i].y));
    if (truth < 0x1p-126L) {
      EXPECT_LE(out[i], 0x1.01p-126f) << in[i].x << " to the " << in[i].y;
      continue;
    }
    const float rounded = static_cast<float>(truth);
    const long double ulp = std::ldexp(1.0L, std::ilogb(rounded) - 23);
    const double error = static_cast<double>(std::abs(static_cast<long double>(out[i]) - truth) / ulp);
    ASSERT_LE(error, 2) << in[i].x << " to the " << in[i].y << " gave " << out[i];
    worst = std::max(worst, error);
    ++checked;
  }
  EXPECT_GT(checked, 400000u);
  RecordProperty("worst_ulp", std::to_string(worst));
}

TEST_P(PowerTest, TheEnds) {
  const std::vector<Case> in = {{1, 0},    {1, 20},     {1, 1e30f},   {0.3f, 0},      {1e-38f, 0},
                                {0.5f, 1}, {0.5f, 126}, {0.5f, 2000}, {0.25f, 1e30f}, {1e-40f, 3e38f}};
  const std::vector<float> out = test::run_kernel<float>(GetParam(), kSource, in);
  const std::vector<float> wanted = {1, 1, 1, 1, 1, 0.5f, 0x1p-126f, 0, 0, 0};
  EXPECT_EQ(out, wanted);
}

constexpr const char* kSourceInDouble = R"(#include "common/power.clh"
__kernel void test(__global const float2* in, __global double* out, uint n) {
  const uint i = get_global_id(0);
  if (i < n) out[i] = power((double16)(in[i].x), (double16)(in[i].y)).s3;
}
)";

TEST_P(PowerTest, InDouble) {
  if (!test::computes_in_double(GetParam()))
    GTEST_SKIP() << "device " << GetParam() << " does not compute in double";
  const unsigned seed = 12;
  SCOPED_TRACE(seed);
  std::vector<Case> in = cases(seed);
  std::erase_if(in, [](const Case& c) { return !(c.x > 0 && c.x <= 1); });
  in.insert(in.end(),
            {{1, 0}, {1, 20}, {1, 1e30f}, {0.3f, 0}, {0.5f, 1}, {0.5f, 1022}, {0.5f, 1023}, {0.25f, 1e30f}});
  const std::vector<double> out =
      test::run_kernel<double>(GetParam(), kSourceInDouble, in, "-DKDRAY_PRECISION=64");
  for (std::size_t i = 0; i < in.size(); ++i) {
    const long double truth = std::pow(static_cast<long double>(in[i].x), static_cast<long double>(in[i].y));
    const long double bound = truth < 0x1p-1022L ? 0x1p-1022L : 0x1p-51L * (4 - std::log2(truth)) * truth;
    ASSERT_LE(std::abs(static_cast<long double>(out[i]) - truth), bound) << in[i].x << " to the " << in[i].y;
  }
}

KDRAY_FOR_EACH_DEVICE(PowerTest);

}  // namespace
}  // namespace kdray
