// What    The film: 64-bit fixed-point sums per pixel and channel (kernels/layout/frame.layout.h has the units).
// Why     Integer addition is exact and has no order: bands, tiles, queues and ranks give the same bits.
#pragma once

#include <cstddef>
#include <vector>

#include "film/image.h"
#include "layout/frame.layout.h"

namespace kdray::wavefront {

class FilmSums {
 public:
  FilmSums(int width, int height);

  // Adds the sums of the pixels that follow `first_pixel`; three per pixel.
  void add(std::size_t first_pixel, const std::vector<layout::i64>& sums);

  // The mean of `samples` samples per pixel.
  film::Image develop(int samples) const;

 private:
  int width_, height_;
  std::vector<layout::i64> sums_;
};

}  // namespace kdray::wavefront
