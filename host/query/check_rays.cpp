#include "query/check_rays.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace kdray::query {

const char* fault_of(const dvec3& origin, const dvec3& direction, double t_min, double t_max) {
  if (!is_finite(origin)) return "its origin is not finite";
  if (!is_finite(direction)) return "its direction is not finite";
  if (direction == dvec3(0)) return "its direction is 0";
  if (!std::isfinite(t_min)) return "its t_min is not finite";
  if (std::isnan(t_max)) return "its t_max is not a number";
  return nullptr;
}

const char* fault_of(const Ray& ray) {
  const auto vector = [](const float(&v)[3]) { return dvec3(v[0], v[1], v[2]); };
  return fault_of(vector(ray.origin), vector(ray.direction), ray.t_min, ray.t_max);
}

namespace {

// fault_of() without a branch: 0 times what is finite is 0.
bool is_ray(const Ray& r) {
  const float nothing = 0 * r.origin[0] + 0 * r.origin[1] + 0 * r.origin[2] + 0 * r.direction[0] +
                        0 * r.direction[1] + 0 * r.direction[2] + 0 * r.t_min;
  const bool goes = (r.direction[0] != 0) | (r.direction[1] != 0) | (r.direction[2] != 0);
  return (nothing == 0) & goes & (r.t_max == r.t_max);
}

float larger(float a, float b) {
  return a > b ? a : b;
}

float largest(const float (&v)[3]) {
  return larger(std::abs(v[0]), larger(std::abs(v[1]), std::abs(v[2])));
}

RaysSeen both(const RaysSeen& a, const RaysSeen& b) {
  return {a.n_rays, std::min(a.first_fault, b.first_fault), a.ordinary && b.ordinary,
          larger(a.farthest, b.farthest)};
}

}  // namespace

RaysSeen look_at(std::span<const Ray> rays) {
  const RaysSeen nothing{rays.size(), rays.size(), true, 0};
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, rays.size(), 1 << 14), nothing,
      [&](const tbb::blocked_range<std::size_t>& range, RaysSeen seen) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          if (!is_ray(rays[i])) seen.first_fault = std::min(seen.first_fault, i);
          seen.ordinary &= is_ordinary(rays[i]);
          seen.farthest = larger(largest(rays[i].origin), seen.farthest);
        }
        return seen;
      },
      both);
}

void refuse_faulty(std::span<const Ray> rays, const RaysSeen& seen) {
  if (seen.first_fault == seen.n_rays) return;
  throw Error(ErrorCode::input, fmt::format("ray {}: {}; take it out or repair it", seen.first_fault,
                                            fault_of(rays[seen.first_fault])));
}

void check_rays(std::span<const Ray> rays) {
  refuse_faulty(rays, look_at(rays));
}

std::vector<Ray> without_faulty(std::span<const Ray> rays) {
  constexpr Ray kNone{{0, 0, 0}, 0, {0, 0, 1}, -1};
  std::vector<Ray> kept(rays.begin(), rays.end());
  std::replace_if(
      kept.begin(), kept.end(), [](const Ray& ray) { return !is_ray(ray); }, kNone);
  return kept;
}

bool is_ordinary(const Ray& ray) {
  const float most = largest(ray.direction);
  return (most >= 0x1p-8f) & (most < 0x1p8f);
}

}  // namespace kdray::query
