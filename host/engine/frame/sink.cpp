#include "engine/frame/sink.h"

#include <algorithm>

#include "engine/checkpoint/header.h"

namespace kdray::frame {

namespace {

// Calls take(pixel, sums) for each row of a tile: its sums from the picture's pixel on.
template <class Take>
void for_each_row(const layout::Frame& frame, layout::u32 tile, checkpoint::Sums sums, const Take& take) {
  const checkpoint::Rectangle r =
      checkpoint::places_of({frame.width, frame.height, frame.tile_width, frame.tile_height}, 0, tile);
  for (std::size_t row = 0; row < r.height; ++row)
    take((r.y + row) * frame.width + r.x, sums.subspan(3 * row * r.width, std::size_t{3} * r.width));
}

}  // namespace

void PictureSink::take_films(wavefront::Films films, std::size_t first_place,
                             std::span<const layout::u32> tiles) {
  wavefront::develop_tiles(films, first_place, frame_, tiles, pixels_);
}

void PictureSink::take_sums(layout::u32 tile, checkpoint::Sums sums) {
  for_each_row(frame_, tile, sums, [&](std::size_t pixel, checkpoint::Sums row) {
    wavefront::develop({&row, 1}, static_cast<int>(frame_.n_samples), pixels_.subspan(pixel, row.size() / 3));
  });
}

void TileSums::take_films(wavefront::Films films, std::size_t first_place,
                          std::span<const layout::u32> tiles) {
  wavefront::copy_tiles(films, first_place, frame_, tiles, sums_);
}

void TileSums::take_sums(layout::u32 tile, checkpoint::Sums sums) {
  for_each_row(frame_, tile, sums, [&](std::size_t pixel, checkpoint::Sums row) {
    std::ranges::copy(row, sums_.subspan(3 * pixel).begin());
  });
}

void RunSums::take_films(wavefront::Films films, std::size_t first_place, std::span<const layout::u32> runs) {
  wavefront::copy_runs(films, first_place, runs, sums_);
}

void RunSums::take_sums(layout::u32 run, checkpoint::Sums sums) {
  std::ranges::copy(sums, sums_.subspan(run * std::size_t{3} * KDRAY_SAMPLE_RUN).begin());
}

}  // namespace kdray::frame
