#include "apps/cli/turntable.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "base/box.h"
#include "base/local_space.h"
#include "base/vec.h"
#include "scene/model/frame.h"

namespace kdray::cli {

namespace {

View::Vector numbers_of(const dvec3& v) {
  return {v.x, v.y, v.z};
}

constexpr double kBorder = 1.06;  // of the picture, around all that is seen in any frame

// Returns points about all that the box passes when it is turned about the line through `middle` along
// `axis`, of unit length: the corners of a prism around a cylinder.
std::vector<dvec3> passed_by(const DBox& box, const dvec3& middle, const dvec3& axis) {
  double radius = 0, half_length = 0;
  for (const dvec3& corner : scene::corners_of(box)) {
    const double along = glm::dot(corner - middle, axis);
    half_length = std::max(half_length, std::abs(along));
    radius = std::max(radius, safe_length(corner - middle - along * axis));
  }
  constexpr int kSides = 32;
  const double reach = radius / std::cos(std::numbers::pi / kSides);
  std::vector<dvec3> points;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    const dvec3 out = scene::turned_to(axis, {reach * std::cos(angle), 0, reach * std::sin(angle)});
    points.push_back(middle + out + half_length * axis);
    points.push_back(middle + out - half_length * axis);
  }
  return points;
}

}  // namespace

Turntable::Turntable(const scene::Scene& seen, const View& asked, double aspect)
    : asked_(asked), camera_(seen.camera.value_or(scene::Camera{})) {
  const scene::Framing& framing = seen.framing;
  const bool is_chosen = framing.camera && !asked.camera && !asked.from;
  if (!is_chosen || framing.box.empty()) return;
  looks_around_ = framing.studio && framing.studio->room;
  if (looks_around_) return;
  const dvec3 way = camera_.from - camera_.at, away = safe_normalize(way);
  if (!asked.at) camera_.at = framing.box.center();
  camera_.from = camera_.at + way;
  const std::vector<dvec3> points = passed_by(framing.box, camera_.at, safe_normalize(camera_.up));
  if (const double distance = scene::distance_to_fit(points, camera_, aspect, kBorder); distance > 0)
    camera_.from = camera_.at + away * distance;
  if (camera_.ortho_width > 0 && asked.ortho_width == 0.0)
    camera_.ortho_width = scene::width_to_show(points, camera_, aspect);
}

View Turntable::after(double turns) const {
  const dvec3& middle = looks_around_ ? camera_.from : camera_.at;
  const auto rotation = glm::rotate(dmat4(1), 2 * std::numbers::pi * turns, safe_normalize(camera_.up));
  const auto turned = [&](const dvec3& p) { return middle + dvec3(rotation * glm::dvec4(p - middle, 0)); };
  View view = asked_;
  view.from = numbers_of(turned(camera_.from));
  view.at = numbers_of(turned(camera_.at));
  view.up = numbers_of(camera_.up);
  if (camera_.ortho_width > 0) view.ortho_width = camera_.ortho_width;
  if (looks_around_ && !view.fov) view.fov = glm::degrees(camera_.vertical_fov);
  return view;
}

}  // namespace kdray::cli
