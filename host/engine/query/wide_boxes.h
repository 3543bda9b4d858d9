// What    The eight boxes of a wide node at once, in plain C++ on the host.
// Shape   Boxes are widened by far more than floats lose, the rounding of places of doubles included.
#pragma once

#include <cstdint>
#include <cstring>

#include "base/local_space.h"
#include "layout/wide.layout.h"

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

}  // namespace kdray::query
