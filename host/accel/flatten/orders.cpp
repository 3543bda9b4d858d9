#include "accel/flatten/orders.h"

#include <algorithm>
#include <array>

#include "accel/flatten/openings.h"

namespace kdray::flatten {

namespace {

// Of each pair of children (a, b): the octants, as bits, in which a goes before b.
using Before = std::array<std::array<std::uint8_t, kWidth>, kWidth>;

// The octants whose rays go upward along an axis.
constexpr std::uint8_t kUpward[3] = {0x55, 0x33, 0x0f};

Before pairs_of(const layout::WideNode& node, std::uint32_t n) {
  Before before{};
  for (std::uint32_t a = 0; a + 1 < n; ++a) {
    std::array<float, kWidth> most;  // by how much a lies before b, or b before a
    std::array<std::uint8_t, kWidth> octants{};
    most.fill(-0x1p127f);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float* const lo = node.bounds[axis][0];
      const float* const hi = node.bounds[axis][1];
      for (std::uint32_t b = 0; b < kWidth; ++b) {
        const float below = lo[b] - hi[a], above = lo[a] - hi[b], apart = std::max(below, above);
        const std::uint8_t upward = kUpward[axis];
        const auto here = static_cast<std::uint8_t>(below >= above ? upward : ~upward);
        octants[b] = apart > most[b] ? here : octants[b];
        most[b] = std::max(most[b], apart);
      }
    }
    for (std::uint32_t b = a + 1; b < n; ++b) {
      before[a][b] = octants[b];
      before[b][a] = static_cast<std::uint8_t>(~octants[b]);
    }
  }
  return before;
}

}  // namespace

// Rays of the opposite octant go the other way along every axis: their order is the same from behind.
void order_anew(layout::WideNode& node, std::uint32_t n) {
  if (n < 2) return;
  const Before before = pairs_of(node, n);
  for (std::uint32_t octant = 0; octant < 4; ++octant) {
    std::array<std::uint32_t, kWidth> near_to_far;
    for (std::uint32_t i = 0; i < n; ++i) near_to_far[i] = node.order[octant] >> (3 * (kWidth - 1 - i)) & 7u;
    for (std::uint32_t i = 1; i < n; ++i)
      for (std::uint32_t j = i; j > 0 && before[near_to_far[j]][near_to_far[j - 1]] >> octant & 1u; --j)
        std::swap(near_to_far[j], near_to_far[j - 1]);
    // Slots without child stay the farthest.
    constexpr std::uint32_t kAll = 0xffffffu;
    const layout::u32 empty = node.order[octant] & (kAll >> (3 * n));
    layout::u32 order = empty, opposite = empty;
    for (std::uint32_t i = 0; i < n; ++i) {
      order |= near_to_far[i] << (3 * (kWidth - 1 - i));
      opposite |= near_to_far[n - 1 - i] << (3 * (kWidth - 1 - i));
    }
    node.order[octant] = order;
    node.order[7 - octant] = opposite;
  }
}

}  // namespace kdray::flatten
