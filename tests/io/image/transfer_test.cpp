#include "io/image/color.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/errors.h"

namespace kdray::image {
namespace {

const Transfer kCurves[] = {{true, 2.2}, {false, 1}, {false, 2.2}, {false, 0.5}, {false, 5}};

TEST(Transfer, SrgbHasTheStandardsValues) {
  const Transfer srgb;
  EXPECT_DOUBLE_EQ(encode(srgb, 0), 0);
  EXPECT_NEAR(encode(srgb, 1), 1, 1e-15);
  EXPECT_NEAR(encode(srgb, 0.002), 12.92 * 0.002, 1e-15);
  EXPECT_NEAR(encode(srgb, 0.5), 0.735356983052449, 1e-12);  // mid grey: 187.5 of 255
  EXPECT_NEAR(decode(srgb, 0.5), 0.214041140482232, 1e-12);
  EXPECT_NEAR(encode(srgb, 0.0031308), encode(srgb, 0.0031309), 1e-5);  // the pieces meet
}

TEST(Transfer, DecodeUndoesEncode) {
  for (const Transfer& curve : kCurves)
    for (int i = 0; i <= 1000; ++i) EXPECT_NEAR(decode(curve, encode(curve, i / 1000.0)), i / 1000.0, 1e-7);
}

TEST(Transfer, RefusesAGammaThatIsNoCurve) {
  for (const double gamma : {0.0, -1.0, std::nan(""), static_cast<double>(INFINITY)})
    EXPECT_TRUE(test::fails([=] { check({false, gamma}); }, "gamma", ErrorCode::usage)) << gamma;
  check({true, 0});  // not used
}

TEST(Quantizer, RoundsTheCurveToNearest) {
  constexpr unsigned kSeed = 7;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> value(0, 1);
  for (const Transfer& curve : kCurves)
    for (const std::uint32_t maximum : {255u, 65535u}) {
      const Quantizer quantize(curve, maximum);
      for (int i = 0; i < 20000; ++i) {
        // Cubed, to look at the dark values as often.
        const float v = i % 2 ? value(random) : std::pow(value(random), 3.0f);
        const double exact = encode(curve, v) * maximum;
        const double got = quantize(v);
        ASSERT_LE(std::abs(got - exact), 0.5 + 1e-6) << v;
      }
    }
}

TEST(Quantizer, ClampsAndMakesNanZero) {
  const Quantizer quantize(Transfer{}, 255);
  EXPECT_EQ(quantize(-1), 0u);
  EXPECT_EQ(quantize(0), 0u);
  EXPECT_EQ(quantize(1), 255u);
  EXPECT_EQ(quantize(std::nextafter(1.0f, 0.0f)), 255u);
  EXPECT_EQ(quantize(7), 255u);
  EXPECT_EQ(quantize(INFINITY), 255u);
  EXPECT_EQ(quantize(-INFINITY), 0u);
  EXPECT_EQ(quantize(NAN), 0u);
}

TEST(Quantizer, EveryCodeSurvivesARoundTrip) {
  for (const Transfer& curve : kCurves)
    for (const std::uint32_t maximum : {255u, 65535u}) {
      const Quantizer quantize(curve, maximum);
      for (std::uint32_t code = 0; code <= maximum; ++code)
        ASSERT_EQ(quantize(static_cast<float>(decode(curve, static_cast<double>(code) / maximum))), code);
    }
}

TEST(Heat, GrowsBrighterAndIsClamped) {
  double before = -1;
  for (int i = 0; i <= 100; ++i) {
    const vec3 c = heat(i / 100.0);
    const double luminance = 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
    EXPECT_GT(luminance, before) << i;
    before = luminance;
  }
  EXPECT_EQ(heat(-1), heat(0));
  EXPECT_EQ(heat(9), heat(1));
  EXPECT_EQ(heat(NAN), vec3(0));
}

}  // namespace
}  // namespace kdray::image
