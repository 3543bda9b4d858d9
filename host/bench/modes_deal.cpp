#include "bench/modes_deal.h"

#include <algorithm>
#include <numeric>

namespace kdray::bench {

namespace {

// Fills runs up to the limit; the last queue takes what is left.
std::vector<std::uint32_t> fill(std::span<const double> costs, std::uint32_t n_queues, double limit) {
  std::vector<std::uint32_t> queue_of(costs.size());
  std::uint32_t queue = 0;
  double held = 0;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    if (held > 0 && held + costs[i] > limit && queue + 1 < n_queues) ++queue, held = 0;
    queue_of[i] = queue;
    held += costs[i];
  }
  return queue_of;
}

double largest_run(std::span<const double> costs, std::span<const std::uint32_t> queue_of) {
  double largest = 0, held = 0;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    held = i > 0 && queue_of[i] == queue_of[i - 1] ? held + costs[i] : costs[i];
    largest = std::max(largest, held);
  }
  return largest;
}

}  // namespace

std::vector<std::uint32_t> deal(std::span<const double> costs, std::uint32_t n_queues) {
  const double all = std::accumulate(costs.begin(), costs.end(), 0.0);
  double low = all / n_queues, high = all;
  for (int step = 0; step < 60 && high - low > 1e-12 * all; ++step) {
    const double limit = 0.5 * (low + high);
    (largest_run(costs, fill(costs, n_queues, limit)) <= limit ? high : low) = limit;
  }
  return fill(costs, n_queues, high);
}

}  // namespace kdray::bench
