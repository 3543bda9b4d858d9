// What    The primitives as the tree and the kernels see them: float, about the scene's own centre, at a size
//         that is the same for all scenes (base/local_space.h). The move and the scaling, by a power of two,
//         are done in double (docs/design/numerics.md), so that a model at (1e6, 1e6, 1e6) keeps its bits,
//         and so does one that is 2^k times as large.
// Shape   One array per kind, in file order; `number` maps back to the file. Degenerate triangles (two equal
//         corners after rounding: their other edges cover each other) and shapes that rounding makes vanish
//         (a radius of 0) are dropped and counted. Triangles of three corners on a line (after rounding,
//         exactly decided) have no area but may close a gap: they are kept (scene/model/zero_area.h).
//         Triangles are as the kernels read them: a device that shares memory takes them from here, without a
//         copy. Copies of a Geometry share them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/box.h"
#include "base/local_space.h"
#include "base/memory.h"
#include "layout/primitives.layout.h"
#include "scene/model/scene.h"
#include "scene/model/zero_area.h"
#include "scene/primitives/shapes.h"

namespace kdray::scene {

using primitives::PrimitiveKind;

using TriangleGeometry = layout::Triangle;
inline vec3 vertex(const TriangleGeometry& t, int i) {
  return {t.v[i][0], t.v[i][1], t.v[i][2]};
}

#define KDRAY_SHAPE(NAME, name, names, Struct) using primitives::Struct##Geometry;
KDRAY_SHAPES(KDRAY_SHAPE)
#undef KDRAY_SHAPE

struct Geometry {
  LocalSpace space;
  Array<TriangleGeometry> triangles;
  RawVector<std::uint32_t> sources;  // of each triangle, the index into Scene::triangles
  std::uint32_t n_smooth = 0;        // triangles with vertex normals, which their `normals` number in order
  std::vector<ZeroAreaTriangle> zero_area;  // all of these have vertex normals
#define KDRAY_SHAPE_ARRAY(NAME, name, names, Struct) std::vector<Struct##Geometry> names;
  KDRAY_SHAPES(KDRAY_SHAPE_ARRAY)
#undef KDRAY_SHAPE_ARRAY
  Box bounds;  // contains every primitive
  std::uint32_t dropped_degenerate = 0;
  std::uint32_t lost = 0;  // of the dropped and those without area, how many have one before rounding
  std::uint32_t fine = 0;  // of the others, those smaller than what floats tell apart over the whole scene

  std::size_t size() const {
    return primitives::count_primitives(*this);
  }
};

// The primitives of a scene that is asked about in doubles (TreeOptions::geometry), as the file or the caller
// has them: in the scene's own space, where its floats are too, and exactly so. (The centre is 0, or within
// twice of every coordinate, so that taking it from them rounds nothing.) Coordinates below kLeast are 0, and
// directions are multiplied by powers of two. Instances are copies there: vertices are where their transforms
// bring them in doubles.
struct DoubleGeometry {
  static constexpr double kLeast = 0x1p-100;

  RawVector<dvec3> vertices;
  RawVector<std::array<std::uint32_t, 3>> corners;  // of each triangle of the Geometry
#define KDRAY_DOUBLE_SHAPES(NAME, name, names, Struct) std::vector<primitives::Struct> names;
  KDRAY_SHAPES(KDRAY_DOUBLE_SHAPES)  // of the Geometry
#undef KDRAY_DOUBLE_SHAPES
  double apart =
      0;          // how far a cone and its floats may lie apart; of other kinds it is 5u of the scene's size
  Copies copies;  // of the scene's instances

  std::size_t n_shapes() const;
  std::array<dvec3, 3> at(std::size_t triangle) const {
    const auto& [a, b, c] = corners[triangle];
    return {vertices[a], vertices[b], vertices[c]};
  }
};
DoubleGeometry make_double_geometry(const Scene& scene, const Geometry& geometry);

// Makes the geometry of a scene without instances that is asked about in doubles: a triangle whose corners
// differ in these is kept though rounding makes two of them equal, and then no ray of floats meets it.
Geometry make_geometry_for_doubles(const Scene& scene);

// Returns whether the floats of this space are its triangles' corners to the bit.
bool fits_floats(const Scene& scene, const LocalSpace& space);

// Makes the geometry in `kept`, where the scene keeps_space(), or else in a space of its own.
Geometry make_geometry(const Scene& scene, const std::optional<LocalSpace>& kept = {});

// Makes the geometry in this space, whatever the scene's bounds: for a part of a larger scene, whose space it
// is.
Geometry make_geometry_in(const LocalSpace& space, const Scene& scene);

// Returns the space of a scene with these bounds. `name` is for the error where they are too large.
LocalSpace space_of(const DBox& bounds, const std::string& name);

// Returns whether a scene that has moved may keep its space: its largest coordinate there is from half of
// kLocalReach to four times that, so that it loses one bit at most. A scene that keeps its space keeps the
// floats of all that has not moved.
bool keeps_space(const LocalSpace& space, const DBox& bounds);

// Returns a warning in one line about a scene whose range is too wide for floats; empty where there is none.
std::string range_warning(const Geometry& geometry);
std::string range_warning(std::size_t lost, std::size_t fine, std::size_t kept);

// Calls visit(Kind(), index) for the i-th of all primitives, counted kind by kind; `index` is its place in
// its kind's array.
template <class Visit>
void visit_primitive(const Geometry& geometry, std::size_t i, const Visit& visit) {
  std::size_t first = 0;
  primitives::for_each_kind([&](auto kind) {
    const auto& primitives = decltype(kind)::of(geometry);
    if (i >= first && i - first < primitives.size()) visit(kind, static_cast<std::uint32_t>(i - first));
    first += primitives.size();
  });
}

// Returns bounds that contain the primitive, rounded outward.
Box bounds_of(const TriangleGeometry& t);
using primitives::bounds_of;

}  // namespace kdray::scene
