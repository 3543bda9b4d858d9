// The sphere test against long double, near and from far away, where the textbook's discriminant is all
// noise.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/vec.h"
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

const char* const kSource =
    "#include \"primitives/sphere/intersect.clh\"\n"
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
    "}\n";

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
  const std::vector<Found> out = test::run_kernel<Found>(GetParam(), kSource, in);
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

// The tangent that a division of rounding by rounding once sent far off, and its mirror images.
TEST_P(SphereTest, ATangentFromTheSphereStaysWhereItTouches) {
  const Case found_once{{0x1.77cc4ap-5f, 0x1.c1426p-3f, -0x1.7995d6p-2f},
                        {0x1.85c366p-1f, 0x1.f1ac4p-2f, -0x1.468ea4p-2f},
                        {0.5f, -0.25f, 0},
                        0.75f};
  std::vector<Case> in;
  for (unsigned mirrored = 0; mirrored < 16; ++mirrored) {
    Case c = found_once;
    for (int k = 0; k < 3; ++k) {
      if (!(mirrored >> k & 1u)) continue;
      c.origin[k] = -c.origin[k], c.direction[k] = -c.direction[k], c.center[k] = -c.center[k];
    }
    if (mirrored & 8u)
      for (float& d : c.direction) d = -d;
    in.push_back(c);
  }
  const std::vector<Found> out = test::run_kernel<Found>(GetParam(), kSource, in);
  for (std::size_t i = 0; i < out.size(); ++i) {
    ASSERT_TRUE(out[i].hit) << i;
    EXPECT_LT(std::abs(out[i].t_near), 2e-3f) << i;
    EXPECT_LT(std::abs(out[i].t_far), 2e-3f) << i;
  }
}

// An error of e across changes the square of half the chord by 2 r e: that is all a tangent has, so such
// errors decide whether it has roots at all, and move them by up to sqrt(2 r e).
TEST_P(SphereTest, TangentsFromTheSphereAgreeWithDouble) {
  const unsigned seed = 22;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(-1, 1), exponent(-3, 3);
  const auto vector = [&] { return dvec3(normal(random), normal(random), normal(random)); };
  std::vector<Case> in;
  for (int i = 0; i < 100000; ++i) {
    Case c{};
    c.radius = static_cast<float>(std::pow(10, exponent(random)));
    const dvec3 center = 3.0 * c.radius * dvec3(unit(random), unit(random), unit(random));
    const dvec3 out = glm::normalize(vector()), along = glm::normalize(glm::cross(out, vector()));
    const double speed = std::pow(10, exponent(random));
    for (int k = 0; k < 3; ++k) {
      c.center[k] = static_cast<float>(center[k]);
      c.origin[k] = static_cast<float>(center[k] + c.radius * out[k]);
      c.direction[k] = static_cast<float>(speed * along[k]);
    }
    in.push_back(c);
  }
  const std::vector<Found> out = test::run_kernel<Found>(GetParam(), kSource, in);
  int n_met = 0, n_compared = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const auto at = [](const float(&p)[3]) { return dvec3(p[0], p[1], p[2]); };
    const dvec3 f = at(in[i].origin) - at(in[i].center), d = at(in[i].direction);
    const double r = in[i].radius, a = glm::dot(d, d), b = -glm::dot(d, f), length = std::sqrt(a);
    const dvec3 closest = f + b / a * d;
    const double half_chord2 = r * r - glm::dot(closest, closest), across = 8 * 0x1p-24 * r;
    const double error2 = 2 * r * across;
    if (std::abs(half_chord2) > error2) {
      ASSERT_EQ(out[i].hit != 0, half_chord2 > 0) << i;
    }
    if (!out[i].hit) continue;
    ++n_met;
    // Where there is no exact root, both are near the closest approach.
    const double least = std::sqrt(std::max(half_chord2 - error2, 0.0));
    const double root = std::sqrt(std::max(half_chord2, 0.0)), most = std::sqrt(half_chord2 + error2);
    const double tolerance = (std::max(most - root, root - least) + across + 2e-6 * root) / length;
    ASSERT_LE(out[i].t_near, out[i].t_far) << i;
    ASSERT_NEAR(out[i].t_near, (b / length - root) / length, tolerance) << i;
    ASSERT_NEAR(out[i].t_far, (b / length + root) / length, tolerance) << i;
    n_compared += half_chord2 > 0;
  }
  EXPECT_GT(n_met, 20000);
  EXPECT_GT(n_compared, 20000);
}

KDRAY_FOR_EACH_DEVICE(SphereTest);

}  // namespace
}  // namespace kdray
