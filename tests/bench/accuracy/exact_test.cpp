// What    The references that are not rendered, against plain sums over many points of a few pixels.
#include "bench/accuracy/exact.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kdray::bench {
namespace {

// The mean of value(right, down) over the pixel, both counted in pixels from the picture's upper left corner.
template <class Value>
double mean_over(int column, int row, int n, const Value& value) {
  double sum = 0;
  for (int i = 0; i < n * n; ++i) sum += value(column + (i % n + 0.5) / n, row + (i / n + 0.5) / n);
  return sum / n / n;
}

float at(const image::Image& image, int column, int row) {
  return image.pixels[static_cast<std::size_t>(row * image.width + column)].x;
}

TEST(ExactScene, TheChessboardIsTheMeanOfItsTexels) {
  const Reference r = exact_scene("chessboard")->reference(64, 48);
  const auto field = [](double right, double down) {
    const double scale = 0.8 / 48, y = (24 - down) * scale;
    if (y >= 0) return 0.0;
    const double x = 0.3 + (right - 32) * scale / -y, z = 0.4 - 1 / -y;
    // The four texels about it, 16 to a field.
    const double i = std::floor(16 * x - 0.5), j = std::floor(16 * z - 0.5);
    const double fx = 16 * x - 0.5 - i, fz = 16 * z - 0.5 - j;
    double sum = 0;
    for (const int k : {0, 1, 2, 3}) {
      const double fields = std::floor((i + k % 2) / 16) + std::floor((j + k / 2) / 16);
      if (fields == 2 * std::floor(fields / 2)) sum += (k % 2 ? fx : 1 - fx) * (k / 2 ? fz : 1 - fz);
    }
    return sum;
  };
  for (const int row : {30, 36, 47})
    for (const int column : {0, 17, 32, 50, 63})
      EXPECT_NEAR(at(r.image, column, row), mean_over(column, row, 1000, field), 4e-3)
          << column << " " << row;
  EXPECT_EQ(at(r.image, 32, 23), 0);  // above the horizon
  EXPECT_LT(r.own_error, 2e-3);
}

TEST(ExactScene, ThePenumbraIsTheMeanOfTheLightThatIsSeen) {
  const Reference r = exact_scene("penumbra")->reference(24, 16);
  const auto light = [](double right, double down) {
    const double x = (12 - right) / 6, z = (8 - down) / 6;
    constexpr int kN = 60;
    double sum = 0;
    for (int i = 0; i < kN * kN; ++i) {
      const double u = 0.1 + 1.6 * ((i % kN + 0.5) / kN - 0.5), v = 1.2 * ((i / kN + 0.5) / kN - 0.5);
      if ((x + u) / 2 < 0) continue;  // where the way to the light meets the sheet, half way up
      sum += 4 / std::sqrt((u - x) * (u - x) + (v - z) * (v - z) + 16);
    }
    return sum / kN / kN;
  };
  for (const int row : {0, 8, 15})
    for (int column = 0; column < 24; ++column)
      EXPECT_NEAR(at(r.image, column, row), mean_over(column, row, 8, light), 4e-3) << column << " " << row;
  EXPECT_LT(r.own_error, 1e-3);
}

TEST(ExactScene, IsNoOtherScene) {
  for (const char* const name : {"chessboard", "penumbra"}) EXPECT_TRUE(exact_scene(name)) << name;
  EXPECT_FALSE(exact_scene("balls"));
}

}  // namespace
}  // namespace kdray::bench
