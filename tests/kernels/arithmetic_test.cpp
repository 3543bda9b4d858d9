// The small arithmetic that exactness rests on, against wider host arithmetic: difference of products (sign
// exact, 1.5 ulp), signed volumes in pairs of floats, and rounding to whole numbers.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "support/device.h"
#include "support/run_kernel.h"

namespace kdray {
namespace {

struct Four {
  float a, b, c, d;
};

class ArithmeticTest : public test::EachDevice {};

// a*b - c*d of floats is exact in binary128's 113 bits.
__float128 exact(const Four& f) {
  return __float128(f.a) * f.b - __float128(f.c) * f.d;
}

std::vector<Four> hard_products(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<Four> in;
  for (int i = 0; i < 200000; ++i) {
    Four f{unit(random), unit(random), unit(random), unit(random)};
    // Two thirds cancel: c*d equals a*b up to a few ulp, or the factors are swapped.
    if (i % 3 == 1) f.d = static_cast<float>(static_cast<double>(f.a) * f.b / f.c);
    if (i % 3 == 2) f = {f.a, f.b, f.b, std::nextafter(f.a, i % 2 ? 2.0f : -2.0f)};
    if (i % 9 == 8) f = {f.a, f.b, f.b, f.a};
    in.push_back(f);
  }
  return in;
}

TEST_P(ArithmeticTest, DifferenceOfProductsHasTheExactSignAndSmallError) {
  const unsigned seed = 7;
  SCOPED_TRACE(seed);
  const std::vector<Four> in = hard_products(seed);
  const std::vector<float> out =
      test::run_kernel<float>(GetParam(),
                              "#include \"common/math.clh\"\n"
                              "__kernel void test(__global const float4* in, __global float* out, uint n) {\n"
                              "  const uint i = get_global_id(0);\n"
                              "  if (i < n) out[i] = diff_of_products(in[i].x, in[i].y, in[i].z, in[i].w);\n"
                              "}\n",
                              in);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const __float128 truth = exact(in[i]);
    ASSERT_EQ(out[i] > 0, truth > 0) << i;
    ASSERT_EQ(out[i] < 0, truth < 0) << i;
    const double error = std::abs(static_cast<double>(out[i] - truth));
    ASSERT_LE(error, 1.5 * std::abs(static_cast<double>(truth)) * 0x1p-23) << i;
  }
}

struct Corners {
  float p[3], a[3], b[3], c[3];
};

double volume(const Corners& k) {
  long double u[3], v[3], w[3];
  for (int i = 0; i < 3; ++i) {
    w[i] = static_cast<long double>(k.a[i]) - k.p[i];
    u[i] = static_cast<long double>(k.b[i]) - k.a[i];
    v[i] = static_cast<long double>(k.c[i]) - k.a[i];
  }
  return static_cast<double>(w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
                             w[2] * (u[0] * v[1] - u[1] * v[0]));
}

TEST_P(ArithmeticTest, SignedVolumeDecidesPointsAFewUlpOffAPlane) {
  const unsigned seed = 11;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<Corners> in;
  for (int i = 0; i < 100000; ++i) {
    Corners k{};
    for (auto* corner : {k.a, k.b, k.c})
      for (int x = 0; x < 3; ++x) corner[x] = unit(random);
    const float s = 0.5f * (unit(random) + 1), t = (1 - s) * 0.5f * (unit(random) + 1);
    for (int x = 0; x < 3; ++x) {
      k.p[x] = k.a[x] + s * (k.b[x] - k.a[x]) + t * (k.c[x] - k.a[x]);
      for (int steps = i % 4; steps > 0; --steps) k.p[x] = std::nextafter(k.p[x], i % 8 < 4 ? 9.0f : -9.0f);
    }
    in.push_back(k);
  }
  const std::vector<float> out = test::run_kernel<float>(
      GetParam(),
      "#include \"common/double_float.clh\"\n"
      "typedef struct Corners { float p[3], a[3], b[3], c[3]; } Corners;\n"
      "__kernel void test(__global const Corners* in, __global float* out, uint n) {\n"
      "  const uint i = get_global_id(0);\n"
      "  if (i >= n) return;\n"
      "  const float3 p = load3(in[i].p), a = load3(in[i].a), b = load3(in[i].b), c = load3(in[i].c);\n"
      "  out[i] = plane_sides(p.x, p.y, p.z, 1, 0, 0, a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, "
      "c.z).distance;\n"
      "}\n",
      in);
  int near_zero = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const double truth = volume(in[i]);
    near_zero += std::abs(truth) < 1e-7;
    if (std::abs(truth) < 0x1p-42) continue;  // its own error
    ASSERT_EQ(out[i] > 0, truth > 0) << i << " " << truth;
  }
  EXPECT_GT(near_zero, 50000);  // the cases are hard: float alone could not tell
}

// Halves, whose neighbours must be even, up to where reals have no more fractions; and reals of all
// exponents.
template <class Real, class Bits>
std::vector<Real> around_wholes(unsigned seed, Real all_whole) {
  std::mt19937_64 random(seed);
  std::vector<Real> in;
  for (Real scale = 1; scale <= 4 * all_whole; scale *= 2)
    for (const Real k :
         {Real{0.5}, Real{1}, Real{1.5}, Real{2.5}, scale - Real{0.5}, scale, scale + Real{0.5}, scale + 1})
      for (const Real v : {k, std::nextafter(k, Real{0}), std::nextafter(k, 2 * k)})
        in.push_back(v), in.push_back(-v);
  for (int i = 0; i < 100000; ++i) {
    const Real v = std::bit_cast<Real>(static_cast<Bits>(random()));
    if (v == v) in.push_back(v);
  }
  const Real infinity = std::numeric_limits<Real>::infinity();
  in.insert(in.end(), {Real{0}, Real{-0.0}, infinity, -infinity});
  return in;
}

template <class Real, class Bits>
void expect_nearest_wholes(const std::string& device, Real all_whole, const std::string& type,
                           const std::string& options) {
  const unsigned seed = 23;
  SCOPED_TRACE(seed);
  const std::vector<Real> in = around_wholes<Real, Bits>(seed, all_whole);
  const std::vector<Real> out =
      test::run_kernel<Real>(device,
                             "#include \"common/math.clh\"\n"
                             "__kernel void test(__global const " +
                                 type + "* in, __global " + type +
                                 "* out, uint n) {\n"
                                 "  const uint i = get_global_id(0);\n"
                                 "  if (i < n) out[i] = nearest_whole((real16)(in[i])).sb;\n"
                                 "}\n",
                             in, options);
  for (std::size_t i = 0; i < in.size(); ++i) ASSERT_EQ(out[i], std::nearbyint(in[i])) << in[i];
}

TEST_P(ArithmeticTest, NearestWholeIsTheNearestAndOfTwoTheEvenOne) {
  expect_nearest_wholes<float, std::uint32_t>(GetParam(), 0x1p23f, "float", "");
  if (test::computes_in_double(GetParam()))
    expect_nearest_wholes<double, std::uint64_t>(GetParam(), 0x1p52, "double", "-DKDRAY_PRECISION=64");
}

KDRAY_FOR_EACH_DEVICE(ArithmeticTest);

}  // namespace
}  // namespace kdray
