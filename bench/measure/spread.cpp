#include "bench/measure/spread.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <thread>

#include "base/timer.h"
#include "bench/measure/report.h"

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

std::string cell(const std::optional<double>& value, int width, int digits) {
  return value ? fmt::format("{:>{}.{}f}", *value, width, digits) : fmt::format("{:>{}}", "-", width);
}

std::map<std::string, std::uint64_t> rays_by_kind(const Statistics& statistics) {
  const Statistics::Rays::Kinds& kinds = statistics.rays.kinds.value();
  return {{"primary", kinds.primary},
          {"shadow", kinds.shadow},
          {"reflected", kinds.reflected},
          {"refracted", kinds.refracted},
          {"total", statistics.rays.total}};
}

Machine machine_of(const Statistics& statistics) {
  const DeviceInfo& device = statistics.device;
  const int all = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const bool is_cpu = device.kind == "cpu";
  return {is_cpu ? std::min(all, static_cast<int>(device.compute_units)) : all, device.name, device.vectors};
}

}  // namespace kdray::bench
