#include "scene/scene.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <utility>

#include "scene/cone_bounds.h"

namespace kdray::scene {

namespace {

constexpr std::size_t kBoundsGrain = std::size_t{1} << 14;

// Only vertices that a triangle uses count: files often carry some that no face names.
DBox triangle_bounds(const Scene& scene) {
  const auto grow = [&](const tbb::blocked_range<std::size_t>& range, DBox box) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const auto& v = scene.triangles[i].vertex;
      DBox triangle{scene.vertices[v[0]], scene.vertices[v[0]]};
      triangle.grow(scene.vertices[v[1]]);
      triangle.grow(scene.vertices[v[2]]);
      box.grow(triangle);
    }
    return box;
  };
  const auto join = [](DBox a, const DBox& b) {
    a.grow(b);
    return a;
  };
  return tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, scene.triangles.size(), kBoundsGrain),
                              DBox(), grow, join);
}

}  // namespace

DBox Scene::bounds() const {
  DBox box = triangle_bounds(*this);
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
