// The film's sums become values of the picture: each the sum times the scale in double, rounded to float,
// whatever the processor's vectors.
#include "wavefront/develop.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "layout/frame.layout.h"

namespace kdray::wavefront {
namespace {

TEST(Develop, RoundsEachValueByItself) {
  const unsigned seed = 41;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  std::vector<layout::i64> sums = {
      0, 1, -1, std::numeric_limits<layout::i64>::max(), std::numeric_limits<layout::i64>::min(), 1ll << 53};
  while (sums.size() < 3 * 1001)  // no multiple of a vector
    sums.push_back(static_cast<layout::i64>(random()) >> (random() % 64));
  for (const int samples : {1, 3, 16, 1000}) {
    std::vector<vec3> pixels(sums.size() / 3);
    develop(sums, samples, pixels);
    const double scale = 1.0 / (static_cast<double>(KDRAY_FILM_SCALE) * samples);
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const volatile double product = static_cast<double>(sums[i]) * scale;
      const auto wanted = static_cast<float>(product);
      EXPECT_EQ(std::bit_cast<std::uint32_t>(pixels[i / 3][static_cast<int>(i % 3)]),
                std::bit_cast<std::uint32_t>(wanted))
          << sums[i] << " of " << samples;
    }
  }
}

TEST(Develop, TakesNoPixels) {
  develop({}, 1, {});
}

}  // namespace
}  // namespace kdray::wavefront
