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
