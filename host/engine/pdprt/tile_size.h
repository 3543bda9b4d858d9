// What    The size of tiles where none is asked for: small enough that the costliest one is a small part of
//         what a compute unit has to do, since the last tile to be begun keeps the frame waiting; large
//         otherwise, since rays of a tile are alike and share what they fetch.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace kdray::pdprt {

// What the tiles of a rendered frame cost.
struct TileCost {
  std::uint64_t tile_pixels = 0;
  double costliest = 0, total = 0;  // seconds of a compute unit

  void add(const TileCost& of_others) {
    costliest = std::max(costliest, of_others.costliest);
    total += of_others.total;
  }
};

constexpr std::uint32_t kLargestTile = 32;

// A square tile's side, `largest` at most. `n_units`: the compute units of all queues. `measured`: of the
// last frame of these sides.
std::uint32_t choose_tile_side(std::uint32_t width, std::uint32_t height, std::uint32_t n_units,
                               const std::optional<TileCost>& measured, std::uint32_t largest = kLargestTile);

}  // namespace kdray::pdprt
