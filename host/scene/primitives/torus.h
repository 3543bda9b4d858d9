// What    Ring tori on the host: all of them but how they are drawn (kernels/primitives/torus/intersect.clh).
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

// The thinnest one: its circle's radius is at most this many of its tube's. The proof that no hit is lost
// asks for it (docs/design/torus.md).
constexpr double kThinnestTorus = 4096;

// The points at `minor_radius` from a circle of `major_radius` about the centre, across the axis.
struct Torus {
  dvec3 center;
  dvec3 axis;           // of any length but 0
  double major_radius;  // > minor_radius
  double minor_radius;  // > 0
  std::uint32_t material = 0;
  std::uint32_t number = 0;
};
constexpr auto fields_of(const Torus*) {
  return std::tuple{Field{"center", "centers", &Torus::center, Meaning::point},
                    Field{"axis", "axes", &Torus::axis, Meaning::direction},
                    Field{"major_radius", "major_radii", &Torus::major_radius, Meaning::above_zero},
                    Field{"minor_radius", "minor_radii", &Torus::minor_radius, Meaning::above_zero}};
}

struct TorusGeometry {
  static constexpr double kFenceFactor = 0;  // see kdtree/build.cpp

  vec3 center, axis;  // unit but for rounding; the torus is the one about it as it is
  float major_radius, minor_radius;
  std::uint32_t source;  // index into Scene::tori
};

// In a file.
const char* fault_of(const Torus& t);
DBox bounds_of(const Torus& t);
dvec3 middle_of(const Torus& t);
void transform(const Similarity& m, Torus& t);

// In the tree.
TorusGeometry geometry_of(const Torus& t, const LocalSpace& space, std::uint32_t source);
bool has_area(const TorusGeometry& t);
Box bounds_of(const TorusGeometry& t);
Bounds clip(const TorusGeometry& t, const Bounds& region);

// For the kernels.
layout::Torus pack(const TorusGeometry& t);
Box bounds_of(const layout::Torus& t);
std::array<float, KDRAY_TORUS_ROWS - 1> rows_of(const layout::Torus& t);

// For queries: the unit normal at a point on it, where a line crosses it, and how far a point is from it, in
// the scene's own space.
dvec3 normal_at(const layout::Torus& t, const dvec3& point);
Crossings crossings(const Line& line, const layout::Torus& t);
double distance_to(const layout::Torus& t, const dvec3& point);
// In a scene of doubles.
dvec3 normal_at(const Torus& t, const dvec3& point);
Crossings crossings(const Line& line, const Torus& t);
NearestOn nearest_on(const Torus& t, const dvec3& point);

// For `kdray verify`.
constexpr bool has_outline(const TorusGeometry&) {
  return false;
}
dvec3 place_on(const TorusGeometry& t, double share, const dvec3& direction);
std::optional<double> sure_target(const Line& line, const TorusGeometry& t, double margin);
dvec3 outward(const dvec3& point, const TorusGeometry& t);
bool meets_again(const Line& line, const TorusGeometry& t, double at, const dvec3& side);

}  // namespace kdray::primitives
