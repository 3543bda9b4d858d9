// The sphere test against long double, near and from far away, where the textbook's discriminant is all noise.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "math/vec.h"
#include "support/device.h"
#include "support/run_kernel.h"

namespace kdray {
namespace {

struct Case {
  float origin[3], direction[3], center[3], radius;
};
struct Found {
  int hit;
  float t_near, t_far;
};

class SphereTest : public test::EachDevice {};

TEST_P(SphereTest, AgreesWithLongDoubleAtAnyDistance) {
  const unsigned seed = 21;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1), exponent(-2, 4);
  std::vector<Case> in;
  for (int i = 0; i < 100000; ++i) {
    Case c{};
    c.radius = 0.5f;
    const float distance = std::pow(10.0f, exponent(random));
    for (int k = 0; k < 3; ++k) {
      c.center[k] = unit(random);
      c.origin[k] = c.center[k] + distance * unit(random);
      c.direction[k] = c.center[k] + c.radius * 1.2f * unit(random) - c.origin[k];
    }
    in.push_back(c);
  }
  const std::vector<Found> out = test::run_kernel<Found>(
      GetParam(),
      "#include \"intersect/sphere.clh\"\n"
      "typedef struct Case { float origin[3], direction[3], center[3], radius; } Case;\n"
      "typedef struct Found { int hit; float t_near, t_far; } Found;\n"
      "__kernel void test(__global const Case* in, __global Found* out, uint n) {\n"
      "  const uint i = get_global_id(0);\n"
      "  if (i >= n) return;\n"
      "  Found f = {0, 0, 0};\n"
      "  f.hit = intersect_sphere(load3(in[i].origin), load3(in[i].direction), load3(in[i].center), "
      "in[i].radius,\n"
      "                           &f.t_near, &f.t_far);\n"
      "  out[i] = f;\n"
      "}\n",
      in);
  int compared = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    using Real = long double;
    Real a = 0, b = 0, f2 = 0;
    for (int k = 0; k < 3; ++k) {
      const Real d = in[i].direction[k], f = Real(in[i].origin[k]) - in[i].center[k];
      a += d * d, b += d * f, f2 += f * f;
    }
    const Real r = in[i].radius, closest2 = f2 - b * b / a, half_chord2 = r * r - closest2;
    // The line's own uncertainty: a few ulp of the distance.
    const Real slack = 8 * Real(0x1p-24) * std::sqrt(f2);
    if (std::abs(r - std::sqrt(std::max(closest2, Real(0)))) < slack) continue;
    ++compared;
    ASSERT_EQ(out[i].hit != 0, half_chord2 > 0) << i;
    if (half_chord2 <= 0) continue;
    const Real root = std::sqrt(half_chord2 / a), length = std::sqrt(a);
    // An error of `slack` across moves the hit along by slack*closest/half_chord.
    const Real tolerance =
        (slack * (1 + r / std::sqrt(half_chord2)) + 4 * Real(0x1p-24) * (std::sqrt(f2) + r)) / length;
    EXPECT_NEAR(out[i].t_near, static_cast<double>(-b / a - root), static_cast<double>(tolerance)) << i;
    EXPECT_NEAR(out[i].t_far, static_cast<double>(-b / a + root), static_cast<double>(tolerance)) << i;
  }
  EXPECT_GT(compared, 90000);
}

KDRAY_FOR_EACH_DEVICE(SphereTest);

}  // namespace
}  // namespace kdray
