#include "odprt/deal.h"

#include <algorithm>
#include <numeric>

namespace kdray::odprt {

namespace {

// Fills one part after the other up to both limits; empty when there are too few parts.
std::vector<std::uint32_t> fill(std::span<const double> costs, std::span<const std::uint64_t> bytes,
                                std::uint32_t n_parts, double most_cost, std::uint64_t most_bytes) {
  std::vector<std::uint32_t> parts(costs.size());
  std::uint32_t part = 0;
  double cost = 0;
  std::uint64_t size = 0;
  bool empty = true;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    if (!empty && (cost + costs[i] > most_cost || size + bytes[i] > most_bytes)) {
      if (++part == n_parts) return {};
      cost = 0, size = 0;
    }
    cost += costs[i], size += bytes[i];
    empty = false;
    parts[i] = part;
    if (costs[i] > most_cost || bytes[i] > most_bytes) return {};
  }
  return parts;
}

// The least cost of the largest part, by bisection; empty when the bytes don't fit.
std::vector<std::uint32_t> balanced(std::span<const double> costs, std::span<const std::uint64_t> bytes,
                                    std::uint32_t n_parts, std::uint64_t most_bytes) {
  double hi = std::accumulate(costs.begin(), costs.end(), 0.0), lo = 0;
  std::vector<std::uint32_t> best = fill(costs, bytes, n_parts, hi, most_bytes);
  if (best.empty()) return best;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (lo + hi);
    std::vector<std::uint32_t> parts = fill(costs, bytes, n_parts, middle, most_bytes);
    (parts.empty() ? lo : hi) = middle;
    if (!parts.empty()) best = std::move(parts);
  }
  return best;
}

}  // namespace

std::vector<std::uint32_t> deal(std::span<const double> costs, std::span<const std::uint64_t> bytes,
                                std::uint32_t n_parts, std::uint64_t most_bytes) {
  if (costs.empty()) return {};
  most_bytes = std::max<std::uint64_t>(most_bytes, 1);
  for (;; most_bytes += most_bytes / 8 + 1) {
    std::vector<std::uint32_t> parts = balanced(costs, bytes, n_parts, most_bytes);
    if (!parts.empty()) return parts;
  }
}

}  // namespace kdray::odprt
