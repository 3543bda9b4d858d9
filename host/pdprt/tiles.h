// What    How PDPRT divides the pixels: tiles in bands of whole tile rows; bands go to queues from a bag of tasks.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "layout/frame.layout.h"

namespace kdray::pdprt {

// A band of whole rows of tiles, and the pixels they cover.
struct Band {
  std::uint32_t first_tile, end_tile;
  std::size_t first_pixel, n_pixels;
};

// Hands each band to whoever asks next; any number of threads.
class Bag {
 public:
  // `rows_per_band` rows of tiles of the frame (its schedule applied) to a band.
  Bag(const layout::Frame& frame, std::uint32_t rows_per_band);

  std::optional<Band> take();
  std::size_t largest_band_pixels() const;

 private:
  Band band(std::uint32_t row) const;

  const layout::Frame frame_;
  std::uint32_t n_rows_, rows_per_band_;
  std::atomic<std::uint32_t> next_row_{0};
};

// Rows of tiles per band: all of them for one queue, else about eight bands a queue, so that a queue with cheap tiles
// takes more of them; never more than a film of `max_film_bytes` holds.
std::uint32_t rows_per_band(const layout::Frame& frame, std::size_t n_queues, std::size_t max_film_bytes);

}  // namespace kdray::pdprt
