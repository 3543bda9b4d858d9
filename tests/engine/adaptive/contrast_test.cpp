// Contrast against closed forms: none on flat and evenly sloping pictures, the step beside an edge, whatever
// the rows to a task.
#include "engine/adaptive/contrast.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace kdray::adaptive {
namespace {

constexpr Size kSize{70, 67};  // more rows than go to one task

std::vector<float> contrast_of(const std::function<double(int x, int y, int channel)>& value) {
  std::vector<layout::i64> sums(3 * kSize.pixels());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const auto pixel = static_cast<int>(i / 3), width = static_cast<int>(kSize.width);
    sums[i] = std::llround(value(pixel % width, pixel / width, static_cast<int>(i % 3)) *
                           static_cast<double>(KDRAY_FILM_SCALE));
  }
  std::vector<float> variance(kSize.pixels());
  contrast(sums, kSize, variance);
  return variance;
}

TEST(Contrast, NoneWhereFlat) {
  for (const float v : contrast_of([](int, int, int c) { return 0.2 + 0.3 * c; })) EXPECT_EQ(v, 0);
}

TEST(Contrast, NoneOnASlopeWithinThePicture) {
  const auto variance = contrast_of([](int x, int y, int) { return x / 128.0 + y / 256.0; });
  for (std::size_t y = 1; y + 1 < kSize.height; ++y)
    for (std::size_t x = 1; x + 1 < kSize.width; ++x) EXPECT_EQ(variance[y * kSize.width + x], 0);
}

TEST(Contrast, AStepOfOneChannelBesideAnEdge) {
  const auto variance = contrast_of([](int x, int, int c) { return c == 1 && x >= 20 ? 0.5 : 0.0; });
  for (std::size_t y = 0; y < kSize.height; ++y)
    for (std::size_t x = 0; x < kSize.width; ++x)
      EXPECT_EQ(variance[y * kSize.width + x], x == 19 || x == 20 ? 0.25f * (1.0f / 36) : 0) << x << " " << y;
}

TEST(Contrast, ALineOnePixelWideIsSeenInAllThree) {
  const auto variance = contrast_of([](int, int y, int) { return y == 32 ? 1.0 : 0.0; });
  EXPECT_EQ(variance[31 * kSize.width + 5], 3 * (1.0f / 36));
  EXPECT_EQ(variance[32 * kSize.width + 5], 12 * (1.0f / 36));
  EXPECT_EQ(variance[33 * kSize.width + 5], 3 * (1.0f / 36));
  EXPECT_EQ(variance[34 * kSize.width + 5], 0);
}

}  // namespace
}  // namespace kdray::adaptive
