// Bands cover the picture once, in order, and none takes more film than it may unless one row of tiles does.
#include "engine/wavefront/tile_order.h"

#include <gtest/gtest.h>

namespace kdray::wavefront {
namespace {

layout::Frame frame_of(std::uint32_t width, std::uint32_t height, std::uint32_t tile) {
  layout::Frame frame = {};
  frame.width = width;
  frame.height = height;
  frame.tile_width = frame.tile_height = tile;
  frame.n_tiles_x = (width + tile - 1) / tile;
  frame.n_tiles = frame.n_tiles_x * ((height + tile - 1) / tile);
  return frame;
}

TEST(Bands, CoverThePictureOnceInOrder) {
  for (const std::uint32_t height : {1u, 31u, 32u, 33u, 100u, 257u}) {
    const layout::Frame frame = frame_of(70, height, 32);
    const std::size_t row_bytes = std::size_t{32} * 70 * 24;
    for (const std::size_t film : {std::size_t{0}, row_bytes, 2 * row_bytes + 5, std::size_t{1} << 40}) {
      SCOPED_TRACE(std::to_string(height) + " rows, film of " + std::to_string(film));
      std::uint32_t row = 0;
      std::size_t pixel = 0;
      for (const Band& band : bands_of(frame, film)) {
        EXPECT_EQ(band.first_row, row);
        EXPECT_EQ(band.first_pixel, pixel);
        EXPECT_GT(band.n_rows, 0u);
        EXPECT_TRUE(band.n_rows == 1 || band.n_pixels * 24 <= film);
        row += band.n_rows;
        pixel += band.n_pixels;
      }
      EXPECT_EQ(row * frame.n_tiles_x, frame.n_tiles);
      EXPECT_EQ(pixel, std::size_t{70} * height);
    }
  }
}

TEST(Bands, AreAsHighAsTheFilmAllows) {
  const layout::Frame frame = frame_of(64, 320, 32);
  EXPECT_EQ(bands_of(frame, std::size_t{3} * 32 * 64 * 24).size(), 4u);  // 10 rows of tiles in threes
  EXPECT_EQ(bands_of(frame, std::size_t{1} << 40).size(), 1u);
}

}  // namespace
}  // namespace kdray::wavefront
