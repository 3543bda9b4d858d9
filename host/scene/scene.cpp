#include "scene/scene.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

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
  primitives::for_each_shape([&](auto kind) {
    for (const auto& shape : decltype(kind)::of(*this)) box.grow(bounds_of(shape));
  });
  return box;
}

}  // namespace kdray::scene
