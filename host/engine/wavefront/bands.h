// What    Cuts a frame into bands of whole rows of tiles, so that a film need not hold all of a large
//         picture.
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

}  // namespace kdray::wavefront
