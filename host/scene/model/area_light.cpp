#include "scene/model/area_light.h"

#include <cmath>

namespace kdray::scene {

void set_disc(Light& light, const dvec3& normal, double radius) {
  const dvec3 a = glm::abs(normal);
  const dvec3 least = a.x <= a.y && a.x <= a.z ? dvec3(1, 0, 0)
                      : a.y <= a.z             ? dvec3(0, 1, 0)
                                               : dvec3(0, 0, 1);
  const dvec3 across = glm::normalize(glm::cross(normal, least));
  light.kind = LightKind::disc;
  light.across = across * radius;
  light.down = glm::cross(normal, across) * radius;
}

}  // namespace kdray::scene
