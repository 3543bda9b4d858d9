#include "bench/modes_deal.h"

#include <numeric>

namespace kdray::bench {

namespace {

struct Limits {
  double cost, bytes;
};

// Fills runs up to the limits; empty when there are too few queues for that.
std::vector<std::uint32_t> fill(std::span<const double> costs, std::span<const double> bytes,
                                std::uint32_t n_queues, const Limits& limits) {
  std::vector<std::uint32_t> queue_of(costs.size());
  std::uint32_t queue = 0;
  Limits held{0, 0};
  for (std::size_t i = 0; i < costs.size(); ++i) {
    if (costs[i] > limits.cost || bytes[i] > limits.bytes) return {};
    if (held.cost + costs[i] > limits.cost || held.bytes + bytes[i] > limits.bytes) {
      if (++queue == n_queues) return {};
      held = {0, 0};
    }
    queue_of[i] = queue;
    held = {held.cost + costs[i], held.bytes + bytes[i]};
  }
  return queue_of;
}

}  // namespace

std::vector<std::uint32_t> deal(std::span<const double> costs, std::span<const double> bytes,
                                std::uint32_t n_queues, double most_bytes) {
  if (costs.empty()) return {};
  const double all = std::accumulate(costs.begin(), costs.end(), 0.0);
  std::vector<std::uint32_t> best = fill(costs, bytes, n_queues, {all, most_bytes});
  while (best.empty()) best = fill(costs, bytes, n_queues, {all, most_bytes = 1.125 * most_bytes + 1});
  for (double low = all / n_queues * (1 - 1e-12), high = all; high - low > 1e-12 * all;) {
    const double limit = 0.5 * (low + high);
    std::vector<std::uint32_t> found = fill(costs, bytes, n_queues, {limit, most_bytes});
    (found.empty() ? low : high) = limit;
    if (!found.empty()) best = std::move(found);
  }
  return best;
}

}  // namespace kdray::bench
