// What    What is said of repeated measurements: the median, and how far they spread.
#pragma once

#include <vector>

namespace kdray::bench {

struct Spread {
  double median = 0, min = 0, max = 0;
};

// All 0 of no values; the mean of the middle two of an even number.
Spread spread_of(std::vector<double> values);

double sum(const std::vector<double>& values);

// Millions of rays per second, from seconds: what was slowest gives the least.
Spread mrays_per_s(std::size_t n_rays, const Spread& seconds);

}  // namespace kdray::bench
