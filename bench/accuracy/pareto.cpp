#include "bench/accuracy/pareto.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace kdray::bench {

std::vector<std::size_t> pareto_front(std::span<const Cost> costs) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < costs.size(); ++i)
    if (std::isfinite(costs[i].seconds) && std::isfinite(costs[i].error)) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tie(costs[a].seconds, costs[a].error, a) < std::tie(costs[b].seconds, costs[b].error, b);
  });
  // From the fastest on, a point is on the front where its error is below that of all before.
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (costs[i].error >= least) continue;
    front.push_back(i);
    least = costs[i].error;
  }
  return front;
}

}  // namespace kdray::bench
