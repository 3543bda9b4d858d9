// The bag hands out each tile and each pixel once, whatever the sizes and however many ask.
#include "pdprt/tiles.h"

#include <gtest/gtest.h>

#include <mutex>
#include <random>
#include <thread>
#include <vector>

#include "layout/features.h"
#include "wavefront/wavefront.h"

namespace kdray::pdprt {
namespace {

layout::Frame frame_of(std::uint32_t width, std::uint32_t height, std::uint32_t tile_w,
                       std::uint32_t tile_h) {
  layout::Frame frame{};
  frame.width = width;
  frame.height = height;
  frame.max_depth = 5;
  wavefront::Schedule schedule;
  schedule.tile_width = tile_w;
  schedule.tile_height = tile_h;
  schedule.apply(frame, 0);
  return frame;
}

std::vector<Band> all_bands(Bag& bag) {
  std::vector<Band> bands;
  while (const std::optional<Band> band = bag.take()) bands.push_back(*band);
  return bands;
}

TEST(Bag, CoversEveryTileAndPixelOnce) {
  const unsigned seed = 1;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const auto pick = [&](std::uint32_t lo, std::uint32_t hi) {
    return std::uniform_int_distribution<std::uint32_t>(lo, hi)(random);
  };
  for (int i = 0; i < 500; ++i) {
    const layout::Frame frame = frame_of(pick(1, 300), pick(1, 300), pick(1, 80), pick(1, 80));
    const std::uint32_t rows = rows_per_band(frame, pick(1, 9), pick(1, 1 << 20));
    Bag bag(frame, rows);
    const std::size_t largest = bag.largest_band_pixels();
    std::uint32_t next_tile = 0;
    std::size_t next_pixel = 0;
    for (const Band& band : all_bands(bag)) {
      EXPECT_EQ(band.first_tile, next_tile);
      EXPECT_EQ(band.first_pixel, next_pixel);
      EXPECT_LE(band.n_pixels, largest);
      next_tile = band.end_tile;
      next_pixel += band.n_pixels;
    }
    EXPECT_EQ(next_tile, frame.n_tiles);
    EXPECT_EQ(next_pixel, std::size_t{frame.width} * frame.height);
  }
}

TEST(Bag, ServesManyThreads) {
  const layout::Frame frame = frame_of(64, 4096, 8, 8);
  Bag bag(frame, 3);
  std::mutex mutex;
  std::vector<int> taken(frame.n_tiles, 0);
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i)
      threads.emplace_back([&] {
        while (const std::optional<Band> band = bag.take()) {
          const std::lock_guard lock(mutex);
          for (std::uint32_t t = band->first_tile; t < band->end_tile; ++t) ++taken[t];
        }
      });
  }
  for (const int count : taken) EXPECT_EQ(count, 1);
}

TEST(RowsPerBand, OneQueueTakesAllThatFits) {
  const layout::Frame frame = frame_of(1024, 1024, 32, 32);
  EXPECT_EQ(rows_per_band(frame, 1, std::size_t{1} << 40), 32u);
  EXPECT_EQ(rows_per_band(frame, 1, 1), 1u);
  EXPECT_EQ(rows_per_band(frame, 1, std::size_t{1024} * 32 * 24 * 5), 5u);
}

TEST(RowsPerBand, SeveralQueuesGetSeveralBandsEach) {
  const layout::Frame frame = frame_of(1024, 1024, 32, 32);
  EXPECT_EQ(rows_per_band(frame, 2, std::size_t{1} << 40), 2u);
  EXPECT_EQ(rows_per_band(frame, 1000, std::size_t{1} << 40), 1u);
}

}  // namespace
}  // namespace kdray::pdprt
