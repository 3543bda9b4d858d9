// What    The order of a picture's tiles: a Hilbert curve over any rectangle, so that a run of tiles lies
//         together, and with it what their rays touch.
// Shape   Each tile is a neighbour of the one before (of odd sides one step in the whole curve may be
//         diagonal).
// Source  J. Cerveny, "gilbert": space-filling curve for rectangular domains of arbitrary size, 2018.
#pragma once

#include <cstdint>
#include <vector>

#include "layout/frame.layout.h"

namespace kdray::wavefront {

// Entries (KDRAY_TILE) of the tiles in `n_rows` rows of `n_columns` tiles, the first row of which is
// `first_row`.
std::vector<layout::u32> tile_curve(std::uint32_t n_columns, std::uint32_t first_row, std::uint32_t n_rows);

}  // namespace kdray::wavefront
