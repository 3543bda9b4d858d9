// What    How many references a tree, and each of its subtrees, may have.
// Why     Splits that only multiply references (needles across many cells, fans around a vertex) still lower
//         the expected cost, without end: the budget ends them.
// Shape   A split hands its budget to its children in proportion to their references. The share depends on
//         the path alone, so threads do not show; it is never below the references that the child has when it
//         is split.
#pragma once

#include <algorithm>
#include <cstddef>

#include "accel/kdtree/build.h"

namespace kdray::kdtree {

// What a primitive may cost on average: enough for any mesh of plain triangles (2.5 for slivers, in leaves of
// 8), and not so much that a mesh of needles takes more than twice their time. The exact builder is for those
// who would rather wait than trace slowly.
inline double reference_budget(std::size_t n_primitives, Quality quality) {
  constexpr double kFree = 1u << 17;  // a small scene may cut its needles finely at little cost
  constexpr double kMost = 1u << 29;  // indices of nodes and references have 30 bits
  const double each = quality == Quality::best ? 32 : 3.5;
  return std::min(kMost, each * static_cast<double>(n_primitives) + kFree);
}

inline bool fits_budget(double budget, std::size_t n_below, std::size_t n_above) {
  return static_cast<double>(n_below + n_above) <= budget;
}

struct Shares {
  double below = 0, above = 0;
};

inline Shares share(double budget, std::size_t n_below, std::size_t n_above) {
  const auto all = static_cast<double>(n_below + n_above);
  if (all == 0) return {};
  return {budget * (static_cast<double>(n_below) / all), budget * (static_cast<double>(n_above) / all)};
}

}  // namespace kdray::kdtree
