// The film's sums become values of the picture: each the sum times the scale in double, rounded to float,
// whatever the processor's vectors.
#include "engine/wavefront/develop.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
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
    std::vector<float> rgb(sums.size());
    const std::span<const layout::i64> films[] = {sums};
    develop(films, samples, rgb);
    const double scale = 1.0 / (static_cast<double>(KDRAY_FILM_SCALE) * samples);
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const volatile double product = static_cast<double>(sums[i]) * scale;
      const auto wanted = static_cast<float>(product);
      EXPECT_EQ(std::bit_cast<std::uint32_t>(rgb[i]), std::bit_cast<std::uint32_t>(wanted))
          << sums[i] << " of " << samples;
    }
  }
}

TEST(Develop, TakesNoPixels) {
  const std::span<const layout::i64> films[] = {{}};
  develop(films, 1, {});
}

// Queues' films: each sum is as exact as one film's would be, and stays at the ends of its range.
TEST(Develop, AddsUpFilms) {
  constexpr auto kLeast = std::numeric_limits<layout::i64>::min(),
                 kMost = std::numeric_limits<layout::i64>::max();
  const unsigned seed = 43;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  std::vector<std::vector<layout::i64>> sums(
      3, std::vector<layout::i64>(3 * 40'001));  // more than a task's pixels
  std::vector<layout::i64> wanted(sums.front().size());
  for (std::size_t i = 0; i < wanted.size(); ++i)
    for (auto& film : sums) {
      film[i] = static_cast<layout::i64>(random()) >> (3 + random() % 60);
      wanted[i] += film[i];
    }
  sums[0][0] = kMost, sums[1][0] = 1, sums[2][0] = -1, wanted[0] = kMost - 1;
  sums[0][1] = -5, sums[1][1] = kLeast, sums[2][1] = 0, wanted[1] = kLeast;
  const std::span<const layout::i64> films[] = {sums[0], sums[1], sums[2]};
  std::vector<layout::i64> added(wanted.size());
  add_up(films, added);
  EXPECT_EQ(added, wanted);
  std::vector<float> of_films(wanted.size()), of_one(wanted.size());
  develop(films, 4, of_films);
  const std::span<const layout::i64> one[] = {wanted};
  develop(one, 4, of_one);
  EXPECT_EQ(of_films, of_one);
}

}  // namespace
}  // namespace kdray::wavefront
