// Sinks get some of a frame's tiles, or runs, by films or as rectangles: these have their sums afterwards, and
// nothing else has changed.
#include "engine/frame/sink.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "engine/frame/frames.h"
#include "engine/wavefront/curve.h"

namespace kdray::frame {
namespace {

using Sums = std::vector<layout::i64>;

// Films of random sums from one of the picture's pixels, or of the samples, on; `all` are what they make
// together.
struct RandomFilms {
  RandomFilms(Random& random, std::size_t first, std::size_t n_places) : first(first), all(3 * n_places) {
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

Sums rectangle(const Sums& all, const checkpoint::Rectangle& r, std::size_t pitch) {
  Sums sums;
  for (std::size_t y = r.y; y < r.y + r.height; ++y) {
    const auto row = all.begin() + static_cast<std::ptrdiff_t>(3 * (y * pitch + r.x));
    sums.insert(sums.end(), row, row + 3 * r.width);
  }
  return sums;
}

class SinkTest : public testing::TestWithParam<int> {
 protected:
  Random random{static_cast<std::uint64_t>(GetParam())};
  const layout::Frame frame = random_frame(random);
  const std::size_t n_pixels = std::size_t{frame.width} * frame.height;
  const std::uint32_t first_row = random.pick(0, frame.n_tiles / frame.n_tiles_x - 1);

  // Some of the tiles behind the film's first row: by films, and by rectangles.
  std::vector<layout::u32> by_films, by_sums;
  const RandomFilms films{random, std::size_t{first_row} * frame.tile_height* frame.width, n_pixels};

  void hand_over(Sink& sink) {
    for (const layout::u32 tile :
         wavefront::tile_curve(frame.n_tiles_x, first_row, frame.n_tiles / frame.n_tiles_x - first_row))
      if (const std::uint32_t which = random.pick(0, 2); which < 2)
        (which == 0 ? by_films : by_sums).push_back(tile);
    sink.take_films(films.films, films.first, by_films);
    for (const layout::u32 tile : by_sums)
      sink.take_sums(tile, rectangle(films.all, checkpoint::places_of(cut_of(frame), 0, tile), frame.width));
  }

  bool was_handed_over(std::size_t pixel) const {
    const auto x = static_cast<std::uint32_t>(pixel % frame.width),
               y = static_cast<std::uint32_t>(pixel / frame.width);
    const layout::u32 tile = KDRAY_TILE(x / frame.tile_width, y / frame.tile_height);
    return std::ranges::count(by_films, tile) + std::ranges::count(by_sums, tile) > 0;
  }
};

TEST_P(SinkTest, ThePictureHasTheMeansOfItsTiles) {
  const vec3 before(-7.0f);
  std::vector<vec3> pixels(n_pixels, before);
  PictureSink sink(frame, pixels);
  hand_over(sink);
  const double scale = 1.0 / (static_cast<double>(KDRAY_FILM_SCALE) * frame.n_samples);
  for (std::size_t p = 0; p < n_pixels; ++p)
    for (int c = 0; c < 3; ++c) {
      const auto sum = static_cast<double>(films.all[3 * p + static_cast<std::size_t>(c)]);
      const volatile double mean = sum * scale;
      ASSERT_EQ(pixels[p][c], was_handed_over(p) ? static_cast<float>(mean) : before[c])
          << "seed " << GetParam() << ", pixel " << p;
    }
}

TEST_P(SinkTest, SumsOfTilesAreKept) {
  Sums sums(3 * n_pixels, -7);
  TileSums sink(frame, sums);
  hand_over(sink);
  for (std::size_t i = 0; i < sums.size(); ++i)
    ASSERT_EQ(sums[i], was_handed_over(i / 3) ? films.all[i] : -7) << "seed " << GetParam() << ", sum " << i;
}

TEST_P(SinkTest, SumsOfRunsAreKept) {
  const std::uint32_t n_runs = random.pick(1, 300), first_run = random.pick(0, n_runs - 1);
  const RandomFilms of_runs(random, std::size_t{first_run} * KDRAY_SAMPLE_RUN,
                            std::size_t{n_runs} * KDRAY_SAMPLE_RUN);
  Sums sums(of_runs.all.size(), -7), wanted = sums;
  RunSums sink(sums);
  std::vector<layout::u32> runs;
  for (layout::u32 run = first_run; run < n_runs; ++run) {
    const std::uint32_t which = random.pick(0, 2);
    const checkpoint::Rectangle r = checkpoint::places_of({}, 1, run);
    const Sums of_run = rectangle(of_runs.all, r, 0);
    if (which == 0) runs.push_back(run);
    if (which == 1) sink.take_sums(run, of_run);
    if (which < 2) std::ranges::copy(of_run, wanted.begin() + 3 * r.x);
  }
  sink.take_films(of_runs.films, of_runs.first, runs);
  EXPECT_EQ(sums, wanted) << "seed " << GetParam();
}

INSTANTIATE_TEST_SUITE_P(Seeds, SinkTest, testing::Range(1, 31));

}  // namespace
}  // namespace kdray::frame
