#include "io/image/compare.h"

#include <gtest/gtest.h>

#include <cmath>

#include "io/image/color.h"
#include "pictures.h"
#include "support/errors.h"

namespace kdray::image {
namespace {

TEST(Compare, EqualPicturesDoNotDiffer) {
  const Image a = noise(20, 10, 1);
  const Difference d = compare(a, a);
  EXPECT_EQ(d.rmse, 0);
  EXPECT_EQ(d.mean_absolute, 0);
  EXPECT_EQ(d.max, 0);
  EXPECT_EQ(d.differing_share, 0);
  EXPECT_EQ(d.flip, 0);
}

TEST(Compare, MeasuresOnePixel) {
  const Image a = flat(4, 2, vec3(0.25f));
  Image b = a;
  b.pixels[3] = vec3(0.75f, 0.25f, 0.0f);  // by 0.5, 0, 0.25
  const Difference d = compare(a, b);
  EXPECT_NEAR(d.rmse, std::sqrt((0.25 + 0.0625) / 24), 1e-12);
  EXPECT_NEAR(d.mean_absolute, 0.75 / 24, 1e-12);
  EXPECT_DOUBLE_EQ(d.max, 0.5);
  EXPECT_DOUBLE_EQ(d.differing_share, 1.0 / 8);
  EXPECT_GT(d.flip, 0);
}

// A fourth channel, of which a picture without alpha has 1 everywhere.
TEST(Compare, AlphaCounts) {
  const Image opaque = flat(4, 1, vec3(0));
  Image holes = opaque;
  holes.alpha = {1, 1, 1, 0.5f};
  const Difference d = compare(opaque, holes);
  EXPECT_NEAR(d.rmse, std::sqrt(0.25 / 16), 1e-12);
  EXPECT_NEAR(d.mean_absolute, 0.5 / 16, 1e-12);
  EXPECT_DOUBLE_EQ(d.max, 0.5);
  EXPECT_DOUBLE_EQ(d.differing_share, 0.25);
  EXPECT_GT(d.flip, 0) << "over black they are the same, over white not";
  EXPECT_EQ(compare(holes, holes).max, 0);
  EXPECT_EQ(compare(holes, holes).flip, 0);
}

TEST(Compare, AnEightBitStepIsNoDifferenceButMoreIs) {
  for (int k = 0; k < 254; ++k) {
    const Image a = flat(1, 1, vec3(static_cast<float>(k) / 255));
    EXPECT_EQ(compare(a, flat(1, 1, vec3(static_cast<float>(k + 1) / 255))).differing_share, 0) << k;
    EXPECT_EQ(compare(a, flat(1, 1, vec3(static_cast<float>(k + 2) / 255))).differing_share, 1) << k;
  }
}

TEST(Compare, NoSumLosesANan) {
  const Image a = flat(2, 2, vec3(0.5f));
  Image b = a;
  b.pixels[0].x = NAN;
  EXPECT_EQ(compare(a, b).max, INFINITY);
  EXPECT_EQ(compare(a, b).rmse, INFINITY);
  EXPECT_EQ(compare(b, b).max, 0);
  const Image bright = flat(2, 2, vec3(INFINITY));
  EXPECT_EQ(compare(bright, bright).rmse, 0);
}

TEST(Compare, RefusesOtherSizes) {
  EXPECT_TRUE(test::fails([] { compare(flat(2, 3, vec3(0)), flat(3, 2, vec3(0))); }, "2 x 3 and 3 x 2"));
  EXPECT_TRUE(
      test::fails([] { difference_image(flat(2, 3, vec3(0)), flat(3, 2, vec3(0))); }, "differ in size"));
}

TEST(DifferenceImage, TheLargestIsTheHottest) {
  const Image a = flat(2, 2, vec3(0));
  Image b = a;
  b.pixels[1] = vec3(0, 0.1f, 0);
  b.pixels[2] = vec3(0.2f, 0, 0);
  b.pixels[3] = vec3(NAN);
  const Image d = difference_image(a, b);
  EXPECT_EQ(d.pixels[0], heat(0));
  EXPECT_LT(glm::distance(d.pixels[1], heat(0.5)), 1e-6);
  EXPECT_EQ(d.pixels[2], heat(1));
  EXPECT_EQ(d.pixels[3], heat(1));
}

TEST(DifferenceImage, EqualPicturesAreBlack) {
  for (const vec3& p : difference_image(noise(3, 3, 1), noise(3, 3, 1)).pixels) EXPECT_EQ(p, vec3(0));
}

}  // namespace
}  // namespace kdray::image
