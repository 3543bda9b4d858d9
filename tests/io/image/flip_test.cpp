// What    FLIP against values worked out by hand and against those of the authors' own program
//         (flip-evaluator 1.7 from PyPI, 67 pixels per degree) on pictures given by formulas.
#include "io/image/compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pictures.h"

namespace kdray::image {
namespace {

constexpr int kWidth = 64, kHeight = 48;

template <class Color>
Image picture(const Color& color) {
  Image image = flat(kWidth, kHeight, vec3(0));
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) image.pixels[static_cast<std::size_t>(y * kWidth + x)] = color(x, y);
  return image;
}

Image ramps() {
  return picture([](int x, int y) {
    return vec3(static_cast<float>(x) / 63, static_cast<float>(y) / 47,
                static_cast<float>((x + y) % 16) / 15);
  });
}

// A red rectangle, a line of inverted green, and less blue everywhere.
Image disturbed(Image image) {
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      vec3& p = image.pixels[static_cast<std::size_t>(y * kWidth + x)];
      if (y >= 10 && y < 20 && x >= 20 && x < 40) p = vec3(0.9f, 0.1f, 0.2f);
      if (y == 30) p.y = 1 - p.y;
      p.z *= 0.8f;
    }
  return image;
}

TEST(Flip, AgreesWithTheAuthorsProgram) {
  const Image reference = ramps();
  const std::vector<float> map = flip_map(reference, disturbed(reference));
  const auto at = [&](int x, int y) { return map[static_cast<std::size_t>(y * kWidth + x)]; };
  EXPECT_NEAR(std::accumulate(map.begin(), map.end(), 0.0) / (kWidth * kHeight), 0.306257, 5e-5);
  EXPECT_NEAR(at(30, 15), 0.798791, 2e-4);
  EXPECT_NEAR(at(5, 30), 0.403817, 2e-4);
  EXPECT_NEAR(at(0, 0), 0.143689, 2e-4);
  EXPECT_NEAR(at(63, 47), 0.330608, 2e-4);
}

TEST(Flip, SeesAnEdgeAsTheAuthorsProgramDoes) {
  const Image edge = picture([](int x, int) { return vec3(x >= 32 ? 1.0f : 0.0f); });
  const std::vector<float> map = flip_map(edge, flat(kWidth, kHeight, vec3(0)));
  EXPECT_NEAR(std::accumulate(map.begin(), map.end(), 0.0) / (kWidth * kHeight), 0.528164, 5e-5);
  EXPECT_NEAR(map[24 * kWidth + 31], 0.992380, 2e-4);
  EXPECT_NEAR(map[24 * kWidth + 32], 0.993944, 2e-4);
}

TEST(Flip, FineStripesAreBarelySeen) {
  const Image even = picture([](int x, int) { return vec3(x % 2 == 0 ? 1.0f : 0.0f); });
  const Image odd = picture([](int x, int) { return vec3(x % 2 == 1 ? 1.0f : 0.0f); });
  EXPECT_NEAR(mean_flip(even, odd), 0.067337, 5e-5);
  EXPECT_NEAR(mean_flip(even, flat(kWidth, kHeight, vec3(0.5f))), 0.078727, 5e-5);
}

TEST(Flip, IsZeroForEqualAndSymmetric) {
  const Image a = noise(40, 30, 1), b = noise(40, 30, 2);
  EXPECT_EQ(mean_flip(a, a), 0);
  EXPECT_NEAR(mean_flip(a, b), mean_flip(b, a), 1e-9);
  EXPECT_GT(mean_flip(a, b), 0.01);
}

TEST(Flip, GreenAgainstBlueIsTheLargestError) {
  EXPECT_NEAR(mean_flip(flat(8, 8, {0, 1, 0}), flat(8, 8, {0, 0, 1})), 1, 1e-5);
}

// Black and white have no chroma: their distance is 100, to the power 0.7 25.12 of green and blue's 41.3.
TEST(Flip, BlackAgainstWhiteIsNearlyOne) {
  const double distance = std::pow(100, 0.7), largest = flip::largest_color_distance();
  const double expected = 0.95 + 0.05 * (distance - 0.4 * largest) / (0.6 * largest);
  EXPECT_NEAR(mean_flip(flat(8, 8, vec3(0)), flat(8, 8, vec3(1))), expected, 1e-5);
  EXPECT_NEAR(expected, 0.96737, 1e-5);
}

TEST(Flip, ClampsToTheDisplay) {
  EXPECT_EQ(mean_flip(flat(8, 8, vec3(1)), flat(8, 8, vec3(50))), 0);
  EXPECT_EQ(mean_flip(flat(8, 8, vec3(0)), flat(8, 8, vec3(-2))), 0);
  EXPECT_EQ(mean_flip(flat(8, 8, vec3(0)), flat(8, 8, vec3(NAN))), 0);
}

TEST(FlipParts, OpponentSpaceOfGreysAndBack) {
  const dvec3 white = flip::ycxcz({1, 1, 1}), black = flip::ycxcz({0, 0, 0});
  EXPECT_NEAR(white.x, 100, 1e-9);
  EXPECT_NEAR(white.y, 0, 1e-9);
  EXPECT_NEAR(white.z, 0, 1e-9);
  EXPECT_NEAR(black.x, -16, 1e-9);
  const dvec3 color(0.2, 0.7, 0.4);
  EXPECT_LT(glm::distance(flip::linear_rgb(flip::ycxcz(color)), color), 1e-12);
}

// CIE L*a*b* of sRGB's green: 87.735, -86.183, 83.180; chroma times 0.87735 is what Hunt's effect leaves.
TEST(FlipParts, HuntLabOfGreen) {
  const dvec3 green = flip::hunt_lab({0, 1, 0});
  EXPECT_NEAR(green.x, 87.735, 5e-3);
  EXPECT_NEAR(green.y, -86.183 * 0.87735, 2e-2);
  EXPECT_NEAR(green.z, 83.180 * 0.87735, 2e-2);
}

TEST(FlipParts, DistanceAndRedistribution) {
  EXPECT_DOUBLE_EQ(flip::hyab({10, 3, 4}, {4, 0, 0}), 11);
  const double largest = flip::largest_color_distance();
  EXPECT_DOUBLE_EQ(flip::redistribute(0), 0);
  EXPECT_NEAR(flip::redistribute(0.2 * largest), 0.475, 1e-12);
  EXPECT_NEAR(flip::redistribute(0.4 * largest), 0.95, 1e-12);
  EXPECT_NEAR(flip::redistribute(largest), 1, 1e-12);
}

}  // namespace
}  // namespace kdray::image
