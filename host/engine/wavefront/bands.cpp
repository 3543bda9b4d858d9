#include "engine/wavefront/bands.h"

#include <algorithm>

namespace kdray::wavefront {

std::vector<Band> bands_of(const layout::Frame& frame, std::size_t max_film_bytes) {
  const std::uint32_t n_rows = frame.n_tiles / frame.n_tiles_x;
  const std::size_t row_bytes = std::size_t{frame.tile_height} * frame.width * 3 * sizeof(layout::i64);
  const auto fitting =
      static_cast<std::uint32_t>(std::clamp<std::size_t>(max_film_bytes / row_bytes, 1, n_rows));
  std::vector<Band> bands;
  for (std::uint32_t row = 0; row < n_rows; row += fitting) {
    const std::uint32_t end = std::min(row + fitting, n_rows);
    const std::size_t y = std::size_t{row} * frame.tile_height;
    const std::size_t end_y = std::min<std::size_t>(std::size_t{end} * frame.tile_height, frame.height);
    bands.push_back({row, end - row, y * frame.width, (end_y - y) * frame.width});
  }
  return bands;
}

}  // namespace kdray::wavefront
