#include "engine/pdprt/tile_size.h"

#include <algorithm>

namespace kdray::pdprt {

namespace {

constexpr std::uint32_t kSmallest = 8;
constexpr std::uint64_t kTilesPerUnit = 64;  // at least
constexpr double kLargestPart = 0.02;        // of a unit's time, for one tile

bool enough_tiles(std::uint32_t width, std::uint32_t height, std::uint32_t side, std::uint32_t n_units) {
  const std::uint64_t columns = (width + side - 1) / side, rows = (height + side - 1) / side;
  return columns * rows >= kTilesPerUnit * n_units;
}

// Whether tiles of this side would be cheap enough, if cost were spread evenly over the costliest tile:
// halves of it can't cost less on average.
bool cheap_enough(const TileCost& cost, std::uint32_t side, std::uint32_t n_units) {
  const double part = static_cast<double>(side) * side / static_cast<double>(cost.tile_pixels);
  return cost.costliest * part * n_units <= kLargestPart * cost.total;
}

}  // namespace

std::uint32_t choose_tile_side(std::uint32_t width, std::uint32_t height, std::uint32_t n_units,
                               const std::optional<TileCost>& measured, std::uint32_t largest) {
  std::uint32_t side = largest;
  while (side > kSmallest && !(enough_tiles(width, height, side, n_units) &&
                               (!measured || cheap_enough(*measured, side, n_units))))
    side /= 2;
  return side;
}

}  // namespace kdray::pdprt
