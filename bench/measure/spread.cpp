#include "bench/measure/spread.h"

#include <algorithm>
#include <numeric>

#include "base/timer.h"

namespace kdray::bench {

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return {median(values), *least, *most};
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

Spread mrays_per_s(std::size_t n_rays, const Spread& seconds) {
  const auto rate = [&](double s) { return s > 0 ? static_cast<double>(n_rays) / s * 1e-6 : 0.0; };
  return {rate(seconds.median), rate(seconds.max), rate(seconds.min)};
}

}  // namespace kdray::bench
