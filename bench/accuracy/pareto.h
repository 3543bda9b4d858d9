// What    The Pareto front of points that have two costs: those that no other one beats.
// Shape   A point is beaten by one that is no worse in both costs and better in one; of equal points the
//         first counts. What is not finite is never on the front.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace kdray::bench {

struct Cost {
  double seconds = 0, error = 0;
};

// The places in `costs` of the points on the front, from the fastest to the one of the least error.
std::vector<std::size_t> pareto_front(std::span<const Cost> costs);

}  // namespace kdray::bench
