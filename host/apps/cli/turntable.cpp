#include "apps/cli/turntable.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

#include "base/box.h"
#include "base/vec.h"
#include "scene/model/frame.h"

namespace kdray::cli {

namespace {

View::Vector numbers_of(const dvec3& v) {
  return {v.x, v.y, v.z};
}

// Returns the bounds of all that the box passes when it is turned about the line through `middle` along
// `axis`, of unit length: those of a cylinder.
DBox turned(const DBox& box, const dvec3& middle, const dvec3& axis) {
  double radius = 0, half_length = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const dvec3 p{corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                  corner & 4 ? box.hi.z : box.lo.z};
    const double along = glm::dot(p - middle, axis);
    half_length = std::max(half_length, std::abs(along));
    radius = std::max(radius, glm::length(p - middle - along * axis));
  }
  dvec3 half;
  for (int k = 0; k < 3; ++k)
    half[k] = radius * std::sqrt(std::max(0.0, 1 - axis[k] * axis[k])) + half_length * std::abs(axis[k]);
  return {middle - half, middle + half};
}

}  // namespace

Turntable::Turntable(const scene::Scene& seen, const View& asked, double aspect)
    : asked_(asked), camera_(seen.camera.value_or(scene::Camera{})) {
  const bool is_chosen = seen.framing.camera && !asked.camera && !asked.from;
  if (!is_chosen || seen.framing.box.empty()) return;
  const DBox all = turned(seen.framing.box, camera_.at, glm::normalize(camera_.up));
  camera_ = scene::three_quarter_view(all, camera_, aspect);
  if (camera_.ortho_width > 0 && asked.ortho_width == 0.0)
    camera_.ortho_width = scene::width_to_show(all, camera_, aspect);
}

View Turntable::after(double turns) const {
  const dvec3 arm = camera_.from - camera_.at;
  const auto rotation = glm::rotate(dmat4(1), 2 * std::numbers::pi * turns, glm::normalize(camera_.up));
  View view = asked_;
  view.from = numbers_of(camera_.at + dvec3(rotation * glm::dvec4(arm, 0)));
  view.at = numbers_of(camera_.at);
  view.up = numbers_of(camera_.up);
  if (camera_.ortho_width > 0) view.ortho_width = camera_.ortho_width;
  return view;
}

}  // namespace kdray::cli
