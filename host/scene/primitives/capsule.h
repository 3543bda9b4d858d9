// What    Capsules on the host: all of them but how they are drawn
//         (kernels/primitives/capsule/intersect.clh).
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

// The points at `radius` from the segment between its ends, which may be one point: a cylinder with round
// ends, or a sphere.
struct Capsule {
  dvec3 start, end;
  double radius;  // > 0
  std::uint32_t material = 0;
  std::uint32_t number = 0;
};
constexpr auto fields_of(const Capsule*) {
  return std::tuple{Field{"start", "starts", &Capsule::start, Meaning::point},
                    Field{"end", "ends", &Capsule::end, Meaning::point},
                    Field{"radius", "radii", &Capsule::radius, Meaning::above_zero}};
}

struct CapsuleGeometry {
  static constexpr double kFenceFactor = 0;  // see kdtree/build.cpp

  vec3 center, axis;  // unit but for rounding; the capsule is the one about it as it is
  float half_length, radius;
  std::uint32_t source;  // index into Scene::capsules
};

// In a file.
const char* fault_of(const Capsule& c);
DBox bounds_of(const Capsule& c);
dvec3 middle_of(const Capsule& c);
void transform(const Similarity& m, Capsule& c);

// In the tree.
CapsuleGeometry geometry_of(const Capsule& c, const LocalSpace& space, std::uint32_t source);
bool has_area(const CapsuleGeometry& c);
Box bounds_of(const CapsuleGeometry& c);
Bounds clip(const CapsuleGeometry& c, const Bounds& region);

// For the kernels.
layout::Capsule pack(const CapsuleGeometry& c);
Box bounds_of(const layout::Capsule& c);
std::array<float, KDRAY_CAPSULE_ROWS - 1> rows_of(const layout::Capsule& c);

// For queries: the unit normal at a point on it, where a line crosses it, and how far a point is from it, in
// the scene's own space.
dvec3 normal_at(const layout::Capsule& c, const dvec3& point);
Crossings crossings(const Line& line, const layout::Capsule& c);
double distance_to(const layout::Capsule& c, const dvec3& point);
// In a scene of doubles.
dvec3 normal_at(const Capsule& c, const dvec3& point);
Crossings crossings(const Line& line, const Capsule& c);
NearestOn nearest_on(const Capsule& c, const dvec3& point);

// For `kdray verify`.
constexpr bool has_outline(const CapsuleGeometry&) {
  return false;
}
dvec3 place_on(const CapsuleGeometry& c, double share, const dvec3& direction);
std::optional<double> sure_target(const Line& line, const CapsuleGeometry& c, double margin);
bool meets_again(const Line& line, const CapsuleGeometry& c, double t, const dvec3& side);

}  // namespace kdray::primitives
