#include "scene/textures/sky.h"

#include <algorithm>
#include <cmath>

#include "base/local_space.h"

namespace kdray::scene {

namespace {

bool is_color(const vec3& v) {
  return is_finite(dvec3(v)) && v.x >= 0 && v.y >= 0 && v.z >= 0;
}

const char* fault_of_stops(const Sky& sky) {
  constexpr double kLeastStep = 1e-6;
  if (sky.stops.empty()) return "a gradient without stops";
  for (std::size_t i = 0; i < sky.stops.size(); ++i) {
    const SkyStop& stop = sky.stops[i];
    if (!(stop.height >= -1 && stop.height <= 1)) return "a stop's height is not from -1 to 1";
    if (!is_color(stop.color)) return "a stop's colour is not finite, or below 0";
    if (i > 0 && !(stop.height - sky.stops[i - 1].height >= kLeastStep))
      return "the stops' heights don't ascend, by a millionth each";
  }
  return nullptr;
}

}  // namespace

SkyAxes axes_of(const Sky& sky) {
  // What is most forward of what is at right angles to `up`; where that is nothing, along y.
  const dvec3 wanted = std::abs(sky.up.z) > 0.999999 ? dvec3(0, 1, 0) : dvec3(0, 0, -1);
  const dvec3 ahead = glm::normalize(wanted - sky.up * glm::dot(wanted, sky.up));
  const dvec3 aside = glm::cross(ahead, sky.up);
  // Turned right-handed about `up`, what was ahead goes to the left.
  const double c = std::cos(sky.turn), s = std::sin(sky.turn);
  return {.right = aside * c + ahead * s, .up = sky.up, .forward = ahead * c - aside * s};
}

double brightest_of(const Sky& sky) {
  double most = sky.picture ? sky.picture->brightest * sky.strength : 0;
  for (const SkyStop& stop : sky.stops)
    most = std::max<double>({most, stop.color.x, stop.color.y, stop.color.z});
  return most;
}

const char* fault_of(const Sky& sky) {
  if (sky.kind == SkyKind::none) return nullptr;
  if (!(std::abs(glm::length(sky.up) - 1) < 1e-6)) return "the sky's 'up' has no unit length";
  if (sky.kind == SkyKind::gradient) return fault_of_stops(sky);
  if (!std::isfinite(sky.turn)) return "the sky's turn is not finite";
  if (!(sky.strength >= 0 && sky.strength <= 1e6)) return "the sky's strength is not from 0 to 1e6";
  return nullptr;
}

}  // namespace kdray::scene
