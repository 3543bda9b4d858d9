#include "engine/query/near_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kdray::query {

namespace {

constexpr double kMostScale =
    0x1p100;  // of the kernels' space; its inverse and its product with kFar are floats

dvec3 vector(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

// What takes a scene that a float can't scale to a size of 1 to one where it can: a power of two.
double shrink_of(const LocalSpace& space) {
  const double scale = std::clamp(space.scale, 1 / kMostScale, kMostScale);
  return space.scale / scale;
}

}  // namespace

NearRays::NearRays(const LocalSpace& space)
    : space_(space),
      kernel_space_{space.center * shrink_of(space), space.scale / shrink_of(space)},
      shrink_(shrink_of(space)) {
  const double limit = space.world_length(kFar) - largest_component(space.center);
  limit_ = static_cast<float>(std::clamp(limit, -1.0, double{std::numeric_limits<float>::max()}));
  if (shrink_ != 1) limit_ = -1;  // none can stay
}

bool NearRays::is_far(const Ray& ray) const {
  return std::max({std::abs(ray.origin[0]), std::abs(ray.origin[1]), std::abs(ray.origin[2])}) > limit_;
}

// In the kernels' world. `ahead` counts, as t does, in multiples of the direction.
Ray NearRays::begin_near(const Ray& ray, double& ahead) const {
  const dvec3 d = vector(ray.direction), from = vector(ray.origin) - space_.center;
  ahead = 0;
  dvec3 origin = from;
  if (!(largest_component(from) <= space_.world_length(kFar))) {
    ahead = -glm::dot(from, d) / glm::dot(d, d);
    origin = from + ahead * d;
  }
  Ray near = ray;
  if (!(largest_component(origin) <= space_.world_length(kFar))) {
    origin = dvec3(0);
    near.t_max = -std::numeric_limits<float>::infinity();
  } else {
    near.t_max = static_cast<float>((ray.t_max - ahead) * shrink_);
  }
  near.t_min = static_cast<float>((ray.t_min - ahead) * shrink_);
  const vec3 moved(origin * shrink_ + kernel_space_.center);
  for (int k = 0; k < 3; ++k) near.origin[k] = moved[k];
  return near;
}

std::span<const Ray> NearRays::take(std::span<const Ray> rays) {
  ahead_.clear();
  if (std::none_of(rays.begin(), rays.end(), [this](const Ray& ray) { return is_far(ray); })) return rays;
  rays_.assign(rays.begin(), rays.end());
  ahead_.assign(rays.size(), 0);
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (is_far(rays[i])) rays_[i] = begin_near(rays[i], ahead_[i]);
  return rays_;
}

void NearRays::give_back(std::span<Hit> hits) const {
  if (ahead_.empty()) return;
  for (std::size_t i = 0; i < hits.size(); ++i)
    if (hits[i].primitive >= 0) hits[i].t = given_back(i, hits[i].t);
}

}  // namespace kdray::query
