#include "flatten/core.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kdray::flatten {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kGrain = 1 << 14;
constexpr float kMargin = 1e-3f;  // of the scene: how far from a face a light is to be

struct Bounds {
  vec3 lo = vec3(kInfinity), hi = vec3(-kInfinity);

  void add(const vec3& a, const vec3& b) { lo = glm::min(lo, a), hi = glm::max(hi, b); }
  void add(const Bounds& o) { add(o.lo, o.hi); }
  bool holds(const Bounds& o) const {
    return glm::all(glm::lessThanEqual(lo, o.lo)) && glm::all(glm::lessThanEqual(o.hi, hi));
  }
  bool empty() const { return !(lo.x <= hi.x); }
};

vec3 corner(const layout::Triangle& t, int i) {
  return {t.v[i][0], t.v[i][1], t.v[i][2]};
}

Bounds bounds_of(const layout::Triangle& t) {
  Bounds b;
  for (int i = 0; i < 3; ++i) b.add(corner(t, i), corner(t, i));
  return b;
}

// About a point, and more than rounding takes away.
Bounds around(const vec3& p, const vec3& reach) {
  const vec3 room = reach + 1e-6f * (glm::abs(p) + reach);
  return {p - room, p + room};
}

Bounds bounds_of(const layout::Sphere& s) {
  return around({s.center[0], s.center[1], s.center[2]}, vec3(s.radius));
}

Bounds bounds_of(const layout::Cone& c) {
  const vec3 base(c.base[0], c.base[1], c.base[2]), axis(c.axis[0], c.axis[1], c.axis[2]);
  // A circle across the axis reaches this far along each coordinate, for a radius of 1; the axis is of unit
  // length but for rounding.
  const vec3 across = glm::sqrt(glm::max(vec3(1e-5f), vec3(1) - axis * axis));
  Bounds b = around(base, c.base_radius * across);
  const float apex_radius = c.base_radius + c.slope * c.height + 1e-6f * (c.base_radius + c.height);
  b.add(around(base + c.height * axis, apex_radius * across + vec3(1e-6f * c.height)));
  return b;
}

template <class Sum, class Items, class Add>
Sum sum_of(const Items& items, Add add) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, items.size(), kGrain), Sum{},
      [&](const tbb::blocked_range<std::size_t>& range, Sum sum) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) add(sum, bounds_of(items[i]));
        return sum;
      },
      [](Sum a, const Sum& b) {
        a.add(b);
        return a;
      });
}

template <class Items>
Bounds bounds_of_all(const Items& items) {
  return sum_of<Bounds>(items, [](Bounds& sum, const Bounds& b) { sum.add(b); });
}

// The boxes of the triangles that lie in each of the planes that bound them all, and of all others.
struct Sides {
  Bounds inner;
  Bounds at[3][2];  // [axis][0: lo, 1: hi]

  void add(const Bounds& triangle, const Bounds& all) {
    for (int k = 0; k < 3; ++k) {
      if (triangle.lo[k] != triangle.hi[k]) continue;
      if (triangle.lo[k] == all.lo[k]) return at[k][0].add(triangle);
      if (triangle.hi[k] == all.hi[k]) return at[k][1].add(triangle);
    }
    inner.add(triangle);
  }
  void add(const Sides& o) {
    inner.add(o.inner);
    for (int k = 0; k < 3; ++k)
      for (int side = 0; side < 2; ++side) at[k][side].add(o.at[k][side]);
  }
};

}  // namespace

Core core_of(const FlatScene& scene) {
  Bounds curved = bounds_of_all(scene.spheres);
  curved.add(bounds_of_all(scene.cones));
  const Bounds all = bounds_of_all(scene.triangles);
  Sides sides = sum_of<Sides>(scene.triangles, [&](Sides& sum, const Bounds& b) { sum.add(b, all); });
  sides.inner.add(curved);
  Core core;
  if (sides.inner.empty()) return core;
  core.lo = sides.inner.lo, core.hi = sides.inner.hi;
  // All triangles in one plane: a face on the side that the core is not.
  for (int k = 0; k < 3; ++k)
    if (all.lo[k] == all.hi[k] && all.lo[k] > 0.5f * (core.lo[k] + core.hi[k]))
      std::swap(sides.at[k][0], sides.at[k][1]);
  // A plane whose triangles lie within the core anyway, as the top of a box does, is no face: they are part
  // of the core.
  const auto is_face = [&](const Bounds& b) { return !b.empty() && !sides.inner.holds(b); };
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
    bool inside = has_faces && lights[i].kind != KDRAY_LIGHT_DIRECTIONAL;
    for (int k = 0; k < 3; ++k)
      inside &= lights[i].position[k] - face_lo[k] > margin && face_hi[k] - lights[i].position[k] > margin;
    if (inside) frame.open_lights |= 1u << i;
  }
}

}  // namespace kdray::flatten
