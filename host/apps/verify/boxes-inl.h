// What    Boxes::touching_pairs: the tree against itself.
#pragma once

#include <tbb/parallel_invoke.h>

#include "apps/verify/boxes.h"

namespace kdray::verify {

template <class Visit>
void Boxes::touching_pairs(const Visit& visit) const {
  if (!order_.empty()) pairs(0, 0, 0, visit);
}

template <class Visit>
void Boxes::pairs(std::uint32_t level, std::uint64_t a, std::uint64_t b, const Visit& visit) const {
  if (a != b && !touch(box_of(level, a), box_of(level, b))) return;
  if (level == levels_) {
    for (std::size_t i = first_of(level, a); i < first_of(level, a + 1); ++i)
      for (std::size_t j = a == b ? i + 1 : first_of(level, b); j < first_of(level, b + 1); ++j)
        if (touch(own_[i], own_[j])) visit(order_[i], order_[j]);
    return;
  }
  const auto below = [&](std::uint64_t i, std::uint64_t j) { pairs(level + 1, 2 * a + i, 2 * b + j, visit); };
  constexpr std::uint32_t kParallelLevels = 8;
  if (a == b) {
    if (level < kParallelLevels) {
      tbb::parallel_invoke([&] { below(0, 0); }, [&] { below(1, 1); });
    } else {
      below(0, 0), below(1, 1);
    }
    below(0, 1);
  } else if (level < kParallelLevels) {
    tbb::parallel_invoke([&] { below(0, 0), below(0, 1); }, [&] { below(1, 0), below(1, 1); });
  } else {
    below(0, 0), below(0, 1), below(1, 0), below(1, 1);
  }
}

}  // namespace kdray::verify
