// What    Flat discs on the host: all of them but how they are drawn (kernels/primitives/disc/intersect.clh).
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

// Seen from both sides.
struct Disc {
  dvec3 center;
  dvec3 normal;   // of any length but 0
  double radius;  // > 0
  std::uint32_t material = 0;
  std::uint32_t number = 0;
};
constexpr auto fields_of(const Disc*) {
  return std::tuple{Field{"center", "centers", &Disc::center, Meaning::point},
                    Field{"normal", "normals", &Disc::normal, Meaning::direction},
                    Field{"radius", "radii", &Disc::radius, Meaning::above_zero}};
}

struct DiscGeometry {
  static constexpr double kFenceFactor = 0;  // see kdtree/build.cpp

  vec3 center, normal;  // unit but for rounding; the plane is the one at right angles to it as it is
  float radius;
  std::uint32_t source;  // index into Scene::discs
};

// In a file.
const char* fault_of(const Disc& d);
DBox bounds_of(const Disc& d);
dvec3 middle_of(const Disc& d);
void transform(const Similarity& m, Disc& d);

// In the tree.
DiscGeometry geometry_of(const Disc& d, const LocalSpace& space, std::uint32_t source);
bool has_area(const DiscGeometry& d);
Box bounds_of(const DiscGeometry& d);
Bounds clip(const DiscGeometry& d, const Bounds& region);

// For the kernels.
layout::Disc pack(const DiscGeometry& d);
Box bounds_of(const layout::Disc& d);
std::array<float, KDRAY_DISC_ROWS - 1> rows_of(const layout::Disc& d);

// For queries: the unit normal at a point on it, where a line crosses it, and how far a point is from it, in
// the scene's own space.
dvec3 normal_at(const layout::Disc& d, const dvec3& point);
Crossings crossings(const Line& line, const layout::Disc& d);
double distance_to(const layout::Disc& d, const dvec3& point);
// In a scene of doubles.
dvec3 normal_at(const Disc& d, const dvec3& point);
Crossings crossings(const Line& line, const Disc& d);
NearestOn nearest_on(const Disc& d, const dvec3& point);

// For `kdray verify`.
constexpr bool has_outline(const DiscGeometry&) {
  return true;
}
dvec3 place_on(const DiscGeometry& d, double share, const dvec3& direction);
std::optional<double> sure_target(const Line& line, const DiscGeometry& d, double margin);
bool meets_again(const Line& line, const DiscGeometry& d, double t, const dvec3& side);

}  // namespace kdray::primitives
