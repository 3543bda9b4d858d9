// What    Spheres on the host: all of them but how they are drawn (kernels/primitives/sphere/intersect.clh).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <tuple>

#include "base/box.h"
#include "base/vec.h"
#include "layout/kinds.h"
#include "layout/primitives.layout.h"
#include "layout/wide.layout.h"
#include "scene/primitives/shape_tools.h"

namespace kdray::primitives {

struct Sphere {
  dvec3 center;
  double radius;  // > 0
  std::uint32_t material = 0;
  std::uint32_t number = 0;
};
constexpr auto fields_of(const Sphere*) {
  return std::tuple{Field{"center", "centers", &Sphere::center, Meaning::point},
                    Field{"radius", "radii", &Sphere::radius, Meaning::above_zero}};
}

struct SphereGeometry {
  static constexpr double kFenceFactor = 0;  // see kdtree/build.cpp

  vec3 center;
  float radius;
  std::uint32_t source;  // index into Scene::spheres
};

// In a file.
const char* fault_of(const Sphere& s);
DBox bounds_of(const Sphere& s);
dvec3 middle_of(const Sphere& s);
void transform(const Similarity& m, Sphere& s);

// In the tree.
SphereGeometry geometry_of(const Sphere& s, const LocalSpace& space, std::uint32_t source);
bool has_area(const SphereGeometry& s);
Box bounds_of(const SphereGeometry& s);
Bounds clip(const SphereGeometry& s, const Bounds& region);

// For the kernels.
layout::Sphere pack(const SphereGeometry& s);
Box bounds_of(const layout::Sphere& s);
std::array<float, KDRAY_SPHERE_ROWS - 1> rows_of(const layout::Sphere& s);

// For queries: the unit normal at a point on it, where a line crosses it, and how far a point is from it, in
// the scene's own space.
dvec3 normal_at(const layout::Sphere& s, const dvec3& point);
Crossings crossings(const Line& line, const layout::Sphere& s);
double distance_to(const layout::Sphere& s, const dvec3& point);
// In a scene of doubles.
dvec3 normal_at(const Sphere& s, const dvec3& point);
Crossings crossings(const Line& line, const Sphere& s);
NearestOn nearest_on(const Sphere& s, const dvec3& point);

// For `kdray verify`.
constexpr bool has_outline(const SphereGeometry&) {
  return true;
}
dvec3 place_on(const SphereGeometry& s, double share, const dvec3& direction);
std::optional<double> sure_hit(const Line& line, const SphereGeometry& s, double margin);
std::optional<double> sure_target(const Line& line, const SphereGeometry& s, double margin);
Quadratic along(const Line& line, const SphereGeometry& s);
dvec3 outward(const dvec3& point, const SphereGeometry& s);
bool meets_again(const Line& line, const SphereGeometry& s, double t, const dvec3& side);

}  // namespace kdray::primitives
