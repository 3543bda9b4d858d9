// Some of a frame's tiles, or runs, out of films or of rectangles of their own: the picture, or the sums,
// have these afterwards, and nothing else has changed.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "engine/wavefront/develop.h"
#include "engine/wavefront/random_frame.h"
#include "engine/wavefront/tile_order.h"

namespace kdray::wavefront {
namespace {

using Sums = std::vector<layout::i64>;
using Tiles = std::vector<layout::u32>;

// Films of random sums from a place on; `all` are what they make together.
struct RandomFilms {
  RandomFilms(test::Random& random, std::size_t first, std::size_t n_places)
      : first(first), all(3 * n_places) {
    sums.resize(random.pick(1, 3), Sums(3 * (n_places - first)));
    for (Sums& film : sums)
      for (std::size_t i = 0; i < film.size(); ++i) all[3 * first + i] += film[i] = random.sum();
    films.assign(sums.begin(), sums.end());
  }
  std::size_t first;
  std::vector<Sums> sums;
  std::vector<std::span<const layout::i64>> films;
  Sums all;
};

class PlacedFilmsTest : public testing::TestWithParam<int> {
 protected:
  test::Random random{static_cast<std::uint64_t>(GetParam())};
  const testing::ScopedTrace trace{__FILE__, __LINE__, testing::Message() << "seed " << GetParam()};
  const layout::Frame frame = test::random_frame(random);
  const std::size_t n_pixels = std::size_t{frame.width} * frame.height;
  const std::uint32_t n_rows = frame.n_tiles / frame.n_tiles_x, first_row = random.pick(0, n_rows - 1);
  const RandomFilms films{random, std::size_t{first_row} * frame.tile_height* frame.width, n_pixels};
  Tiles handed_over;

  // Some tiles of the films as they are, some as rectangles.
  template <class Take>
  void hand_over(const Take& take) {
    Tiles whole;
    for (const layout::u32 tile : tile_curve(frame.n_tiles_x, first_row, n_rows - first_row)) {
      const std::uint32_t which = random.pick(0, 2);
      if (which == 2) continue;
      handed_over.push_back(tile);
      if (which == 0)
        whole.push_back(tile);
      else
        hand_over_alone(tile, take);
    }
    take(PlacedFilms{films.films, films.first, frame.width}, whole);
  }

  template <class Take>
  void hand_over_alone(layout::u32 tile, const Take& take) {
    const std::size_t x = KDRAY_TILE_COLUMN(tile) * std::size_t{frame.tile_width},
                      y = KDRAY_TILE_ROW(tile) * std::size_t{frame.tile_height};
    const std::size_t width = std::min<std::size_t>(frame.tile_width, frame.width - x),
                      height = std::min<std::size_t>(frame.tile_height, frame.height - y);
    Sums sums;
    for (std::size_t row = y; row < y + height; ++row)
      for (std::size_t i = 0; i < 3 * width; ++i) sums.push_back(films.all[3 * (row * frame.width + x) + i]);
    const std::span<const layout::i64> film = sums;
    take(PlacedFilms{{&film, 1}, y * width + x, width}, Tiles{tile});
  }

  bool has(std::size_t pixel) const {
    const auto x = static_cast<std::uint32_t>(pixel % frame.width),
               y = static_cast<std::uint32_t>(pixel / frame.width);
    return std::ranges::count(handed_over, KDRAY_TILE(x / frame.tile_width, y / frame.tile_height)) == 1;
  }
};

TEST_P(PlacedFilmsTest, TilesAreDeveloped) {
  const float before = -7;
  std::vector<float> rgb(3 * n_pixels, before);
  hand_over([&](const PlacedFilms& from, const Tiles& tiles) { develop_tiles(from, frame, tiles, rgb); });
  const double scale = 1.0 / (static_cast<double>(KDRAY_FILM_SCALE) * frame.n_samples);
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    const volatile double mean = static_cast<double>(films.all[i]) * scale;
    ASSERT_EQ(rgb[i], has(i / 3) ? static_cast<float>(mean) : before) << "value " << i;
  }
}

TEST_P(PlacedFilmsTest, SumsOfTilesAreCopied) {
  Sums sums(3 * n_pixels, -7);
  hand_over([&](const PlacedFilms& from, const Tiles& tiles) { copy_tiles(from, frame, tiles, sums); });
  for (std::size_t i = 0; i < sums.size(); ++i)
    ASSERT_EQ(sums[i], has(i / 3) ? films.all[i] : -7) << "sum " << i;
}

TEST_P(PlacedFilmsTest, SumsOfRunsAreCopied) {
  const std::uint32_t n_runs = random.pick(1, 300), first = random.pick(0, n_runs - 1);
  const RandomFilms of_runs(random, std::size_t{first} * KDRAY_SAMPLE_RUN,
                            std::size_t{n_runs} * KDRAY_SAMPLE_RUN);
  Sums sums(of_runs.all.size(), -7), wanted = sums;
  std::vector<layout::u32> runs;
  for (layout::u32 run = first; run < n_runs; ++run) {
    if (random.pick(0, 1) == 0) continue;
    runs.push_back(run);
    const std::size_t begin = std::size_t{3} * run * KDRAY_SAMPLE_RUN;
    std::copy_n(of_runs.all.begin() + static_cast<std::ptrdiff_t>(begin), 3 * KDRAY_SAMPLE_RUN,
                wanted.begin() + static_cast<std::ptrdiff_t>(begin));
  }
  copy_runs({of_runs.films, of_runs.first, 0}, runs, sums);
  EXPECT_EQ(sums, wanted);
}

INSTANTIATE_TEST_SUITE_P(Seeds, PlacedFilmsTest, testing::Range(1, 31));

}  // namespace
}  // namespace kdray::wavefront
