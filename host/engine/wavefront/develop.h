// What    From the film's 64-bit fixed-point sums (kernels/layout/frame.layout.h has the units) to linear
//         RGB.
// Shape   Three sums, and three floats, for each pixel. Several queues may have a film each of the same
//         pixels (ODPRT); what counts is the sum of their sums, which saturates as the kernels' adding does.
// Why     Integer addition is exact and has no order: bands, tiles and queues give the same bits.
#pragma once

#include <span>

#include "layout/frame.layout.h"

namespace kdray::wavefront {

// Films of the same pixels, at least one.
using Films = std::span<const std::span<const layout::i64>>;

// Films of some places: of the picture's whole rows, of a tile alone, or of samples.
struct PlacedFilms {
  Films films;
  std::size_t first = 0, pitch = 0;  // place of the films; places from a row of pixels to the next

  // Where the sums of a pixel are, or with y = 0 those of a sample.
  std::size_t at(std::size_t x, std::size_t y) const { return 3 * (y * pitch + x - first); }
};

// The mean of `samples` samples for each of the pixels.
void develop(Films films, int samples, std::span<float> rgb);

// The sums alone, added up.
void add_up(Films films, std::span<layout::i64> sums);

// The same for the pixels of some tiles of a picture (entries of a list: KDRAY_TILE), which the films have;
// the others are left as they are.
void develop_tiles(const PlacedFilms& from, const layout::Frame& frame, std::span<const layout::u32> tiles,
                   std::span<float> picture);

// The sums themselves, to where the picture's are: three for each pixel.
void copy_tiles(const PlacedFilms& from, const layout::Frame& frame, std::span<const layout::u32> tiles,
                std::span<layout::i64> picture_sums);

// Those of runs of samples, to where all runs' are.
void copy_runs(const PlacedFilms& from, std::span<const layout::u32> runs, std::span<layout::i64> sums);

}  // namespace kdray::wavefront
