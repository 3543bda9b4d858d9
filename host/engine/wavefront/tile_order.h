// What    How a picture's tiles follow each other: in bands of whole rows of tiles, so that a film need not
//         hold all of a large picture, and along a curve.
// Shape   The bands are in order, without gaps, of equal height but for the last.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "layout/frame.layout.h"

namespace kdray::wavefront {

struct Band {
  std::uint32_t first_row = 0, n_rows = 0;    // of tiles
  std::size_t first_pixel = 0, n_pixels = 0;  // of the picture
};

// Bands are as high as a film of `max_film_bytes` allows, and one row of tiles at least.
std::vector<Band> bands_of(const layout::Frame& frame, std::size_t max_film_bytes);

// The order of a picture's tiles: a Hilbert curve over any rectangle, so that a run of tiles lies together,
// and with it what their rays touch. Each tile is a neighbour of the one before (of odd sides one step in
// the whole curve may be diagonal). Source: J. Cerveny, "gilbert": space-filling curve for rectangular
// domains of arbitrary size, 2018.
//
// Entries (KDRAY_TILE) of the tiles in `n_rows` rows of `n_columns` tiles, the first row of which is
// `first_row`.
std::vector<layout::u32> tile_curve(std::uint32_t n_columns, std::uint32_t first_row, std::uint32_t n_rows);

}  // namespace kdray::wavefront
