// What    The eight boxes of a wide node at once, and the primitives of a leaf, in plain C++ on the host.
// Shape   Boxes are widened by far more than floats lose, the rounding of places of doubles included.
#pragma once

#include <cstdint>
#include <cstring>

#include "accel/flatten/wide.h"
#include "base/local_space.h"
#include "layout/wide.layout.h"
#include "scene/primitives/kinds.h"

namespace kdray::query {

// Half of the slots of a node at once.
using Slots = float __attribute__((vector_size(16)));
using SlotsChosen = int __attribute__((vector_size(16)));

inline Slots slots_at(const float* values) {
  Slots slots;
  std::memcpy(&slots, values, sizeof slots);
  return slots;
}
inline Slots lesser(const Slots& a, const Slots& b) {
  return a < b ? a : b;
}
inline Slots greater(const Slots& a, const Slots& b) {
  return a > b ? a : b;
}

// Of all slots: chosen_of(first) tells which of [first, first + 4).
template <class ChosenOf>
std::uint32_t choose_slots(const ChosenOf& chosen_of) {
  std::uint32_t bits = 0;
  for (int first = 0; first < 8; first += 4) {
    const SlotsChosen chosen = chosen_of(first);
    for (int i = 0; i < 4; ++i) bits |= static_cast<std::uint32_t>(chosen[i] & 1) << (first + i);
  }
  return bits;
}

// By how much the boxes of places of floats are widened: so that rounding `place` to floats doesn't count.
inline float widened(double margin, const dvec3& place) {
  return static_cast<float>(margin + 0x1p-19 * largest_component(place));
}

// Calls visit(kind, index, its words) for each primitive until one call answers true; whether one did.
template <class Visit>
bool visit_leaf(const flatten::WideForm& wide, std::uint32_t leaf, const Visit& visit) {
  return primitives::with_kind(flatten::leaf_kind(leaf), [&](auto kind) {
    using Kind = decltype(kind);
    const auto block = static_cast<std::size_t>(wide.block);
    const layout::u32* rows =
        Kind::blocks_of(wide).data() + (leaf & KDRAY_WIDE_FIRST_MASK) * std::size_t{Kind::kRows} * block;
    for (;; rows += Kind::kRows * block)
      for (std::size_t i = 0; i < block; ++i) {
        const layout::u32 index = rows[(Kind::kRows - 1) * block + i];
        if (visit(kind, index & ~KDRAY_WIDE_LAST, rows + i)) return true;
        if (index & KDRAY_WIDE_LAST) return false;
      }
  });
}

}  // namespace kdray::query
