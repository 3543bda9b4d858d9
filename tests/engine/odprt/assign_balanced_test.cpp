// What    Subtrees assigned to parts: none lost, the largest part at most as large as the best of all ways to
//         give each part one run of neighbours, bytes kept to; and several runs where one won't do.
#include "engine/odprt/assign.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace kdray::test {
namespace {

using Costs = std::vector<double>;
using Bytes = std::vector<std::uint64_t>;

constexpr std::uint64_t kSeed = 5;

double largest_cost(const Costs& costs, const std::vector<std::uint32_t>& parts, std::uint32_t n_parts) {
  Costs sums(n_parts);
  for (std::size_t i = 0; i < costs.size(); ++i) sums[parts[i]] += costs[i];
  return *std::max_element(sums.begin(), sums.end());
}

std::uint64_t largest_bytes(const Bytes& bytes, const std::vector<std::uint32_t>& parts,
                            std::uint32_t n_parts) {
  Bytes sums(n_parts);
  for (std::size_t i = 0; i < bytes.size(); ++i) sums[parts[i]] += bytes[i];
  return *std::max_element(sums.begin(), sums.end());
}

// The least cost of the largest run over all ways to cut into at most n_parts runs that keep to the bytes;
// inf: there is none.
double best_of_all(const Costs& costs, const Bytes& bytes, std::uint32_t n_parts, std::uint64_t most_bytes) {
  double best = std::numeric_limits<double>::infinity();
  const auto try_cuts = [&](auto&& self, std::size_t first, std::uint32_t left, double largest) -> void {
    if (first == costs.size()) best = std::min(best, largest);
    if (first == costs.size() || left == 0) return;
    double cost = 0;
    std::uint64_t size = 0;
    for (std::size_t end = first + 1; end <= costs.size(); ++end) {
      cost += costs[end - 1], size += bytes[end - 1];
      if (size > most_bytes) break;
      self(self, end, left - 1, std::max(largest, cost));
    }
  };
  try_cuts(try_cuts, 0, n_parts, 0);
  return best;
}

TEST(AssignBalanced, TheLargestPartIsAsSmallAsCanBe) {
  std::mt19937_64 random(kSeed);
  int limited = 0, scattered = 0;
  for (int round = 0; round < 300; ++round) {
    const std::size_t n = 1 + random() % 9;
    const auto n_parts = static_cast<std::uint32_t>(1 + random() % 4);
    Costs costs(n);
    Bytes bytes(n);
    for (double& c : costs) c = static_cast<double>(random() % 100);
    for (std::uint64_t& b : bytes) b = 1 + random() % 50;
    const std::uint64_t all = std::accumulate(bytes.begin(), bytes.end(), std::uint64_t{0});
    const std::uint64_t most = round % 2 ? all : all / n_parts + 20;
    const auto parts = odprt::assign_balanced(costs, bytes, n_parts, most);
    ASSERT_EQ(parts.size(), n);
    EXPECT_LT(*std::max_element(parts.begin(), parts.end()), n_parts);
    const double best = best_of_all(costs, bytes, n_parts, most);
    if (best == std::numeric_limits<double>::infinity()) continue;  // the bytes can't be kept to
    limited += most < all;
    EXPECT_LE(largest_bytes(bytes, parts, n_parts), most);
    const double largest = largest_cost(costs, parts, n_parts);
    EXPECT_LE(largest, best * (1 + 1e-9)) << "round " << round;
    if (std::is_sorted(parts.begin(), parts.end())) {
      EXPECT_NEAR(largest, best, 1e-9 * (1 + best)) << "round " << round;
    } else {
      ++scattered;
    }
  }
  EXPECT_GT(limited, 50);
  EXPECT_GT(scattered, 10);
  EXPECT_LT(scattered, 250);
}

TEST(AssignBalanced, ALimitThatCannotBeKeptIsRaised) {
  const auto parts = odprt::assign_balanced(Costs{1, 1, 1}, Bytes{100, 100, 100}, 2, 10);
  EXPECT_LE(largest_bytes({100, 100, 100}, parts, 2), 230u);
}

TEST(AssignBalanced, CostsAndBytesInDifferentPlacesAreAssignedInSeveralRuns) {
  // All the cost in the first quarter, all the bytes spread: one run each would leave a part idle.
  Costs costs(64, 0.01);
  std::fill(costs.begin(), costs.begin() + 16, 1.0);
  const Bytes bytes(64, 10);
  const auto parts = odprt::assign_balanced(costs, bytes, 2, 650 * 64 / 100);
  EXPECT_LE(largest_bytes(bytes, parts, 2), 650u * 64 / 100);
  EXPECT_LE(largest_cost(costs, parts, 2), 1.06 * std::accumulate(costs.begin(), costs.end(), 0.0) / 2);
}

TEST(AssignBalanced, NothingAndCostsOfNothing) {
  EXPECT_TRUE(odprt::assign_balanced({}, {}, 3, 100).empty());
  EXPECT_EQ(odprt::assign_balanced(Costs{0, 0, 0}, Bytes{0, 0, 0}, 2, 0).size(), 3u);
}

}  // namespace
}  // namespace kdray::test
