// What    Rays from outside that are none: what is wrong with them, and their refusal.
// Errors  check_rays, refuse_faulty: ErrorCode::input for the first ray that is none, by its number: NaN
//         anywhere, an infinite origin or t_min, a direction that is infinite or 0.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/vec.h"
#include "kdray/ray.h"

namespace kdray::query {

// In words, or null.
const char* fault_of(const dvec3& origin, const dvec3& direction, double t_min, double t_max);
const char* fault_of(const Ray& ray);

// A direction whose largest component lies from the one to below the other is traced as long as it is: others
// are scaled to about unit length (length_exponent() of query.clh). Where that is so of all rays of a launch,
// the kernels need not look.
inline constexpr float kShortestOrdinary = 0x1p-8f, kLongestOrdinary = 0x1p8f;
template <class Real>
constexpr bool is_ordinary_length(Real largest) {
  return largest >= Real{kShortestOrdinary} && largest < Real{kLongestOrdinary};
}

// What one look at rays tells.
struct RaysSeen {
  std::size_t n_rays;
  std::size_t first_fault;  // the number of the first that is none; n_rays: all are
  bool ordinary;            // the kernels need not look at the directions' lengths: is_ordinary() of each
  float farthest;           // the largest coordinate of an origin
};
RaysSeen look_at(std::span<const Ray> rays);

// Throws unless `seen` has no fault. `first`: the number of the first of these rays.
void refuse_faulty(std::span<const Ray> rays, const RaysSeen& seen, std::size_t first = 0);

void check_rays(std::span<const Ray> rays);

// The same rays, but for those that are none: these meet nothing.
std::vector<Ray> without_faulty(std::span<const Ray> rays);

bool is_ordinary(const Ray& ray);

}  // namespace kdray::query
