#include "scene/scene.h"

#include <utility>

#include "scene/cone_bounds.h"

namespace kdray::scene {

// Only vertices that a triangle uses count: files often carry some that no face names.
DBox Scene::bounds() const {
  DBox box;
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t.vertex) box.grow(vertices[v]);
  }
  for (const Sphere& s : spheres) {
    box.grow(s.center - s.radius);
    box.grow(s.center + s.radius);
  }
  for (const Cone& c : cones) {
    const dvec3 reach = disc_reach(c.apex - c.base);
    for (const auto& [end, radius] : {std::pair{c.base, c.base_radius}, std::pair{c.apex, c.apex_radius}}) {
      box.grow(end - radius * reach);
      box.grow(end + radius * reach);
    }
  }
  return box;
}

}  // namespace kdray::scene
