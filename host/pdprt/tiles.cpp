#include "pdprt/tiles.h"

#include <algorithm>

namespace kdray::pdprt {

namespace {

constexpr std::uint32_t kBandsPerQueue = 8;

std::uint32_t tile_rows(const layout::Frame& frame) {
  return frame.n_tiles / frame.n_tiles_x;
}

}  // namespace

Bag::Bag(const layout::Frame& frame, std::uint32_t rows_per_band)
    : frame_(frame), n_rows_(tile_rows(frame)), rows_per_band_(rows_per_band) {}

Band Bag::band(std::uint32_t row) const {
  const std::uint32_t end_row = std::min(row + rows_per_band_, n_rows_);
  const std::size_t first_y = std::size_t{row} * frame_.tile_height;
  const std::size_t end_y = std::min<std::size_t>(std::size_t{end_row} * frame_.tile_height, frame_.height);
  return {row * frame_.n_tiles_x, end_row * frame_.n_tiles_x, first_y * frame_.width,
          (end_y - first_y) * frame_.width};
}

std::optional<Band> Bag::take() {
  const std::uint32_t row = next_row_.fetch_add(rows_per_band_);
  if (row >= n_rows_) return std::nullopt;
  return band(row);
}

std::size_t Bag::largest_band_pixels() const {
  return band(0).n_pixels;
}

std::uint32_t rows_per_band(const layout::Frame& frame, std::size_t n_queues, std::size_t max_film_bytes) {
  const std::uint32_t rows = tile_rows(frame);
  const std::size_t row_bytes = std::size_t{frame.tile_height} * frame.width * 3 * sizeof(layout::i64);
  const auto fitting =
      static_cast<std::uint32_t>(std::clamp<std::size_t>(max_film_bytes / row_bytes, 1, rows));
  if (n_queues == 1) return fitting;
  const auto share = static_cast<std::uint32_t>(rows / (n_queues * kBandsPerQueue));
  return std::clamp<std::uint32_t>(share, 1, fitting);
}

}  // namespace kdray::pdprt
