#include "query/check_rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace kdray::query {

namespace {

bool all_finite(const float (&v)[3]) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

}  // namespace

const char* fault_of(const Ray& ray) {
  if (!all_finite(ray.origin)) return "its origin is not finite";
  if (!all_finite(ray.direction)) return "its direction is not finite";
  if (ray.direction[0] == 0 && ray.direction[1] == 0 && ray.direction[2] == 0) return "its direction is 0";
  if (!std::isfinite(ray.t_min)) return "its t_min is not finite";
  if (std::isnan(ray.t_max)) return "its t_max is not a number";
  return nullptr;
}

void check_rays(std::span<const Ray> rays) {
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (const char* fault = fault_of(rays[i]))
      throw Error(ErrorCode::input, fmt::format("ray {}: {}; take it out or repair it", i, fault));
}

bool is_ordinary(const Ray& ray) {
  const float largest =
      std::max({std::abs(ray.direction[0]), std::abs(ray.direction[1]), std::abs(ray.direction[2])});
  return largest >= 0x1p-8f && largest < 0x1p8f;
}

}  // namespace kdray::query
