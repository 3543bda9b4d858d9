// What    What is said of repeated measurements: the median, and how far they spread.
#pragma once

#include <cstddef>
#include <vector>

namespace kdray::bench {

struct Spread {
  double median = 0, min = 0, max = 0;
};

// Of no values, all is 0; of an even number, the median is the mean of the middle two.
Spread spread_of(std::vector<double> values);

double sum(const std::vector<double>& values);

// Millions of rays per second, from seconds: what was slowest gives the least.
Spread mrays_per_s(std::size_t n_rays, const Spread& seconds);

}  // namespace kdray::bench
