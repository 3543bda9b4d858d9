// What    Truncated cones and cylinders on the host: all of them but how they are drawn
//         (kernels/primitives/cone/intersect.clh).
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

// Without end caps, seen from both sides.
struct Cone {
  dvec3 base, apex;                 // end points of the axis, apart
  double base_radius, apex_radius;  // >= 0, not both 0
  std::uint32_t material = 0;
  std::uint32_t number = 0;
};
constexpr auto fields_of(const Cone*) {
  return std::tuple{
      Field{"base", "bases", &Cone::base, Meaning::point},
      Field{"base_radius", "base_radii", &Cone::base_radius, Meaning::at_least_zero},
      Field{"apex", "apexes", &Cone::apex, Meaning::point},
      Field{"apex_radius", "apex_radii", &Cone::apex_radius, Meaning::at_least_zero_or_left_out}};
}

struct ConeGeometry {
  static constexpr double kFenceFactor = 7;  // see kdtree/build.cpp

  vec3 base, apex;
  float base_radius, apex_radius;
  std::uint32_t source;  // index into Scene::cones
};

// In a file.
const char* fault_of(const Cone& c);
DBox bounds_of(const Cone& c);
dvec3 middle_of(const Cone& c);
void transform(const Similarity& m, Cone& c);

// In the tree.
ConeGeometry geometry_of(const Cone& c, const LocalSpace& space, std::uint32_t source);
bool has_area(const ConeGeometry& c);
Box bounds_of(const ConeGeometry& c);
Bounds clip(const ConeGeometry& c, const Bounds& region);

// For the kernels.
layout::Cone pack(const ConeGeometry& c);
Box bounds_of(const layout::Cone& c);
std::array<float, KDRAY_CONE_ROWS - 1> rows_of(const layout::Cone& c);

// For queries: the unit normal at a point on it, where a line crosses it, and how far a point is from it, in
// the scene's own space.
dvec3 normal_at(const layout::Cone& c, const dvec3& point);
Crossings crossings(const Line& line, const layout::Cone& c);
double distance_to(const layout::Cone& c, const dvec3& point);
// In a scene of doubles.
dvec3 normal_at(const Cone& c, const dvec3& point);
Crossings crossings(const Line& line, const Cone& c);
NearestOn nearest_on(const Cone& c, const dvec3& point);
// Gives it a height, along its axis, where floats leave none.
void keep_height(ConeGeometry& c, const Cone& source);
// Returns how far apart the two may lie, both in the scene's own space: a cone that is short and wide is
// tilted by the rounding of its ends.
double apart(const Cone& c, const ConeGeometry& of_floats);

// For `kdray verify`.
constexpr bool has_outline(const ConeGeometry&) {
  return false;
}
dvec3 place_on(const ConeGeometry& c, double share, const dvec3& direction);
std::optional<double> sure_target(const Line& line, const ConeGeometry& c, double margin);
Quadratic along(const Line& line, const ConeGeometry& c);
dvec3 outward(const dvec3& point, const ConeGeometry& c);
bool meets_again(const Line& line, const ConeGeometry& c, double t, const dvec3& side);

}  // namespace kdray::primitives
