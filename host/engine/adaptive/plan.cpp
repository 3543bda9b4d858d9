#include "engine/adaptive/plan.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

namespace kdray::adaptive {

namespace {

constexpr double kLittle = 1.1;

// For each level, the share of a pixel's price that is left when it goes one level up.
std::array<double, kLevels - 1> left_by_step() {
  std::array<double, kLevels - 1> left{};
  for (int level = 0; level + 1 < kLevels; ++level) {
    const double price = static_cast<double>(remains_at(level)) / samples_of(level);
    left[static_cast<std::size_t>(level)] =
        static_cast<double>(remains_at(level + 1)) / samples_of(level + 1) / price;
  }
  return left;
}

}  // namespace

float remains_at(int level) {
  if (level == 0) return 0.5f;
  const auto n = static_cast<float>(samples_of(level));
  return 1 / (n * std::sqrt(n));
}

Refined refined(int level, double price, double limit_price, int most) {
  static const std::array<double, kLevels - 1> kLeft = left_by_step();
  const int end = std::min(level + most, kLevels - 1);
  for (; level < end && price > limit_price; ++level) price *= kLeft[static_cast<std::size_t>(level)];
  return {level, price};
}

void Prices::add(const Prices& other) {
  std::transform(counts_.begin(), counts_.end(), other.counts_.begin(), counts_.begin(), std::plus<>());
}

std::uint64_t Prices::pixels(int level) const {
  const auto first = counts_.begin() + static_cast<std::ptrdiff_t>(at(level, 0));
  return static_cast<std::uint64_t>(std::accumulate(first, first + kClasses, std::int64_t{0}));
}

double Prices::sum_for(std::uint32_t limit) const {
  const double limit_price = limit < kClasses ? price_of(limit) : std::numeric_limits<double>::infinity();
  double sum = 0;
  for (int level = 0; level < kLevels; ++level)
    for (std::uint32_t number = 1; number < kClasses; ++number) {
      const std::int64_t count = counts_[at(level, number)];
      if (count == 0) continue;
      const Refined r = refined(level, price_of(number), limit_price);
      sum += static_cast<double>(count) * r.price * samples_of(r.level);
    }
  return sum;
}

std::uint32_t Prices::limit_for(double wanted) const {
  wanted = std::max(wanted, kLittle * sum_for(0));
  std::uint32_t low = 0, high = kClasses;  // the sum for `low` is small enough, that for `high` is not
  while (high - low > 1) {
    const std::uint32_t middle = (low + high) / 2;
    (sum_for(middle) <= wanted ? low : high) = middle;
  }
  return low;
}

}  // namespace kdray::adaptive
