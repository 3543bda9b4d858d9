// What    Primitives on their way from who has read them to who holds them: as the kernels have them, with
//         their numbers in the file and what belongs to their corners.
// Shape   Each kind is in the order of the file. A triangle's `normals` is its place among the set's own.
//         `colors` has a row for each triangle or none at all, `texcoords` as many rows for each as there are
//         sets.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "accel/flatten/flatten.h"
#include "base/raw_vector.h"
#include "layout/kinds.h"
#include "scene/model/geometry.h"
#include "scene/model/scene.h"
#include "scene/primitives/shapes.h"

namespace kdray::partition {

template <class Geometry>
struct Placed {
  Geometry shape;
  std::uint32_t number, material;
};

struct PrimitiveSet {
  RawVector<layout::Triangle> triangles;
  RawVector<layout::VertexNormals> normals;
  RawVector<layout::CornerColors> colors;
  RawVector<layout::TexCoords> texcoords;
#define KDRAY_SHAPE_ARRAY(NAME, name, names, Struct) std::vector<Placed<primitives::Struct##Geometry>> names;
  KDRAY_SHAPES(KDRAY_SHAPE_ARRAY)
#undef KDRAY_SHAPE_ARRAY
  // Places of zero-area triangles to which the file gives no normals.
  std::vector<std::uint32_t> bare_zero_area;

  std::size_t size() const {
    return primitives::count_primitives(*this);
  }
};

// From the first of n to before the last: which of n things are the `rank`-th of `size` ranks'.
struct Slice {
  std::size_t first = 0, last = 0;
};
inline Slice slice_of(std::size_t n, int rank, int size) {
  const auto at = [&](int r) {
    return static_cast<std::size_t>(static_cast<unsigned __int128>(n) * static_cast<unsigned>(r) /
                                    static_cast<unsigned>(size));
  };
  return {at(rank), at(rank + 1)};
}

// Of each kind of a flattened scene the rank's slice, behind what there is.
void add_slice(PrimitiveSet& set, const scene::Scene& scene, const scene::Geometry& geometry,
               const flatten::FlatScene& flat, int rank, int size);

// visit(number, bounds) for each of the primitives, in the order of kinds.
template <class Visit>
void for_each_box(const PrimitiveSet& set, const Visit& visit) {
  for (const layout::Triangle& t : set.triangles) visit(t.number, scene::bounds_of(t));
  primitives::for_each_shape([&](auto kind) {
    for (const auto& s : decltype(kind)::of(set)) visit(s.number, bounds_of(s.shape));
  });
}

}  // namespace kdray::partition
