// What    From the film's 64-bit fixed-point sums (kernels/layout/frame.layout.h has the units) to linear
//         RGB.
// Shape   Three sums for each pixel. Several queues may have a film each of the same pixels (ODPRT); what
//         counts is the sum of their sums, which saturates as the kernels' adding does.
// Why     Integer addition is exact and has no order: bands, tiles and queues give the same bits.
#pragma once

#include <span>

#include "base/vec.h"
#include "layout/frame.layout.h"

namespace kdray::wavefront {

// Films of the same pixels, at least one.
using Films = std::span<const std::span<const layout::i64>>;

// The mean of `samples` samples for each of the pixels.
void develop(Films films, int samples, std::span<vec3> pixels);

// The sums alone, added up.
void add_up(Films films, std::span<layout::i64> sums);

// The same for the pixels of some tiles of a picture (entries of a list: KDRAY_TILE), the others left as they
// are. The films begin with the picture's pixel `first_pixel`, the first of its row, and reach over all rows
// of the tiles.
void develop_tiles(Films films, std::size_t first_pixel, const layout::Frame& frame,
                   std::span<const layout::u32> tiles, std::span<vec3> picture);

// The sums themselves, to where the picture's are: three for each pixel.
void copy_tiles(Films films, std::size_t first_pixel, const layout::Frame& frame,
                std::span<const layout::u32> tiles, std::span<layout::i64> picture_sums);

// Sums of runs of samples, to where those of all runs are. The films begin with the sample `first_place`.
void copy_runs(Films films, std::size_t first_place, std::span<const layout::u32> runs,
               std::span<layout::i64> sums);

}  // namespace kdray::wavefront
