#include "engine/odprt/assign.h"

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

// Assigns one run to each part. The bound on a part's bytes is raised until it can be kept.
std::vector<std::uint32_t> in_runs(std::span<const double> costs, std::span<const std::uint64_t> bytes,
                                   std::uint32_t n_parts, std::uint64_t most_bytes) {
  for (;; most_bytes += most_bytes / 8 + 1) {
    std::vector<std::uint32_t> parts = balanced(costs, bytes, n_parts, most_bytes);
    if (!parts.empty()) return parts;
  }
}

struct PartLoad {
  double cost = 0;
  std::uint64_t bytes = 0;
};

std::vector<PartLoad> loads_of(std::span<const double> costs, std::span<const std::uint64_t> bytes,
                               std::span<const std::uint32_t> parts, std::size_t n_parts) {
  std::vector<PartLoad> loads(n_parts);
  for (std::size_t i = 0; i < costs.size(); ++i) {
    loads[parts[i]].cost += costs[i];
    loads[parts[i]].bytes += bytes[i];
  }
  return loads;
}

double largest_cost(std::span<const PartLoad> loads) {
  return std::max_element(loads.begin(), loads.end(),
                          [](const PartLoad& a, const PartLoad& b) { return a.cost < b.cost; })
      ->cost;
}

// Cuts into runs of about equal cost and gives them, the costliest first, each to the part that has least so
// far and can hold it; empty where one fits nowhere.
std::vector<std::uint32_t> in_several_runs(std::span<const double> costs,
                                           std::span<const std::uint64_t> bytes, std::uint32_t n_parts,
                                           std::uint64_t most_bytes, std::uint32_t runs_per_part) {
  const std::uint32_t n_runs = n_parts * runs_per_part;
  const std::vector<std::uint32_t> run_of = in_runs(costs, bytes, n_runs, most_bytes / 2);
  const std::vector<PartLoad> runs = loads_of(costs, bytes, run_of, n_runs);
  std::vector<std::uint32_t> order(n_runs), part_of(n_runs);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return runs[a].cost > runs[b].cost; });
  std::vector<PartLoad> parts(n_parts);
  for (const std::uint32_t run : order) {
    std::uint32_t best = n_parts;
    for (std::uint32_t part = 0; part < n_parts; ++part)
      if (parts[part].bytes + runs[run].bytes <= most_bytes &&
          (best == n_parts || parts[part].cost < parts[best].cost))
        best = part;
    if (best == n_parts) return {};
    parts[best].cost += runs[run].cost;
    parts[best].bytes += runs[run].bytes;
    part_of[run] = best;
  }
  std::vector<std::uint32_t> assigned(costs.size());
  for (std::size_t i = 0; i < costs.size(); ++i) assigned[i] = part_of[run_of[i]];
  return assigned;
}

constexpr double kEven = 1.05;  // the largest part against the mean
constexpr std::uint32_t kMostRuns = 16;

}  // namespace

std::vector<std::uint32_t> assign_balanced(std::span<const double> costs,
                                           std::span<const std::uint64_t> bytes, std::uint32_t n_parts,
                                           std::uint64_t most_bytes) {
  if (costs.empty()) return {};
  most_bytes = std::max<std::uint64_t>(most_bytes, 1);
  std::vector<std::uint32_t> best = in_runs(costs, bytes, n_parts, most_bytes);
  const double even = std::accumulate(costs.begin(), costs.end(), 0.0) / n_parts * kEven;
  double least = largest_cost(loads_of(costs, bytes, best, n_parts));
  for (std::uint32_t runs = 2; runs <= kMostRuns && least > even; runs *= 2) {
    std::vector<std::uint32_t> parts = in_several_runs(costs, bytes, n_parts, most_bytes, runs);
    if (parts.empty()) continue;
    // More runs make more rays travel, so they must be worth it.
    const double largest = largest_cost(loads_of(costs, bytes, parts, n_parts));
    if (largest > 0.95 * least) continue;
    least = largest;
    best = std::move(parts);
  }
  return best;
}

std::vector<bool> replicate(std::span<const double> visits, std::span<const std::uint64_t> bytes,
                            std::uint64_t most_bytes) {
  std::vector<std::size_t> order(visits.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return visits[a] * static_cast<double>(bytes[b]) > visits[b] * static_cast<double>(bytes[a]);
  });
  std::vector<bool> chosen(visits.size());
  for (const std::size_t i : order) {
    if (bytes[i] > most_bytes || visits[i] <= 0) continue;
    most_bytes -= bytes[i];
    chosen[i] = true;
  }
  return chosen;
}

}  // namespace kdray::odprt
