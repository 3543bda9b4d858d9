#include "bench/spread.h"

#include <algorithm>

namespace kdray::bench {

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  const double median = values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
  return {median, values.front(), values.back()};
}

Spread mrays_per_s(std::size_t n_rays, const Spread& seconds) {
  const auto rate = [&](double s) { return s > 0 ? static_cast<double>(n_rays) / s * 1e-6 : 0.0; };
  return {rate(seconds.median), rate(seconds.max), rate(seconds.min)};
}

}  // namespace kdray::bench
