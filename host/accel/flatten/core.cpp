#include "accel/flatten/core.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "scene/primitives/shapes.h"

namespace kdray::flatten {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kGrain = 1 << 14;
constexpr float kMargin = 1e-3f;  // of the scene: how far from a face a light is to be

vec3 corner(const layout::Triangle& t, int i) {
  return {t.v[i][0], t.v[i][1], t.v[i][2]};
}

Box bounds_of(const layout::Triangle& t) {
  Box b;
  for (int i = 0; i < 3; ++i) b.grow(corner(t, i));
  return b;
}
using primitives::bounds_of;

template <class Sum, class Items, class Add>
Sum sum_of(const Items& items, Add add) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, items.size(), kGrain), Sum{},
      [&](const tbb::blocked_range<std::size_t>& range, Sum sum) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) add(sum, items[i]);
        return sum;
      },
      [](Sum a, const Sum& b) {
        a.grow(b);
        return a;
      });
}

template <class Items>
Box bounds_of_all(const Items& items) {
  return sum_of<Box>(items, [](Box& sum, const auto& item) { sum.grow(bounds_of(item)); });
}

}  // namespace

// A zero-area triangle in a plane may be hit from either side of the plane, so it is no part of a face.
void Sides::add(const layout::Triangle& t, const Box& all) {
  const Box triangle = bounds_of(t);
  for (int k = 0; k < 3 && !scene::is_zero_area(t); ++k) {
    if (triangle.lo[k] != triangle.hi[k]) continue;
    if (triangle.lo[k] == all.lo[k]) return at[k][0].grow(triangle);
    if (triangle.hi[k] == all.hi[k]) return at[k][1].grow(triangle);
  }
  inner.grow(triangle);
}

void Sides::grow(const Sides& o) {
  inner.grow(o.inner);
  for (int k = 0; k < 3; ++k)
    for (int side = 0; side < 2; ++side) at[k][side].grow(o.at[k][side]);
}

Box triangle_bounds(const FlatScene& scene) {
  return bounds_of_all(scene.triangles);
}

Sides sides_of(const FlatScene& scene, const Box& all) {
  Sides sides =
      sum_of<Sides>(scene.triangles, [&](Sides& sum, const layout::Triangle& t) { sum.add(t, all); });
  primitives::for_each_shape([&](auto kind) { sides.inner.grow(bounds_of_all(decltype(kind)::of(scene))); });
  return sides;
}

Core core_of(const FlatScene& scene) {
  if (!scene.instances.empty()) return {};  // their meshes are among the primitives, elsewhere than they lie
  const Box all = triangle_bounds(scene);
  return core_of(all, sides_of(scene, all));
}

Core core_of(const Box& all, Sides sides) {
  Core core;
  if (sides.inner.empty()) return core;
  core.is_known = true;
  core.lo = sides.inner.lo, core.hi = sides.inner.hi;
  // Where all triangles are in one plane, the face is on the side where the core is not.
  for (int k = 0; k < 3; ++k)
    if (all.lo[k] == all.hi[k] && all.lo[k] > 0.5f * (core.lo[k] + core.hi[k]))
      std::swap(sides.at[k][0], sides.at[k][1]);
  // A plane whose triangles lie within the core anyway, as the top of a box does, is no face: they are part
  // of the core.
  const auto is_face = [&](const Box& b) { return !b.empty() && !sides.inner.contains(b); };
  for (int k = 0; k < 3; ++k) {
    core.face_lo[k] = is_face(sides.at[k][0]) ? all.lo[k] : -kInfinity;
    core.face_hi[k] = is_face(sides.at[k][1]) ? all.hi[k] : kInfinity;
    core.has_faces |= is_face(sides.at[k][0]) || is_face(sides.at[k][1]);
  }
  return core;
}

void Core::apply(layout::Frame& frame, const Array<layout::Light>& lights) const {
  for (int k = 0; k < 3; ++k) {
    frame.core_lo[k] = lo[k], frame.core_hi[k] = hi[k];
    frame.face_lo[k] = face_lo[k], frame.face_hi[k] = face_hi[k];
  }
  frame.open_lights = 0;
  const float margin = kMargin * frame.world_max;
  for (std::size_t i = 0; i < std::min<std::size_t>(lights.size(), 32); ++i) {
    const layout::Light& light = lights[i];
    bool inside = is_known && light.kind != KDRAY_LIGHT_DIRECTIONAL;
    for (int k = 0; k < 3; ++k) {
      const float reach = std::abs(light.across[k]) + std::abs(light.down[k]) + light.radius;  // of its area
      inside &= light.position[k] - reach - face_lo[k] > margin &&
                face_hi[k] - (light.position[k] + reach) > margin;
    }
    if (inside) frame.open_lights |= 1u << i;
  }
}

}  // namespace kdray::flatten
