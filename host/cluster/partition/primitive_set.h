// What    Primitives on their way from the rank that has read them to the rank that holds them: as the
//         kernels have them, with their numbers in the file and what belongs to their corners; and the two
//         steps that all ranks take with them together: normals for zero-area triangles, and the way itself.
// Shape   Each kind is in the order of the file. A triangle's `normals` is its place among the set's own.
//         `colors` has a row for each triangle or none at all, `texcoords` as many rows for each as there are
//         sets.
//         Primitives travel in batches, which all ranks exchange at the same time. The receiver knows before
//         how many come from whom, and puts each where it belongs.
// Memory  Of the way: the primitives that go and those that have come, and a batch. Of the normals: all
//         zero-area triangles of the scene, on every rank.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "accel/flatten/flatten.h"
#include "base/memory.h"
#include "cluster/transport/together.h"
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

// Which of n things the `rank`-th of `size` ranks has: from `first` to before `last`.
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

// Appends the rank's slice of each kind of a flattened scene.
void add_slice(PrimitiveSet& set, const scene::Scene& scene, const scene::Geometry& geometry,
               const flatten::FlatScene& flat, int rank, int size);

// Calls visit(number, bounds) for each of the primitives, in the order of kinds.
template <class Visit>
void for_each_box(const PrimitiveSet& set, const Visit& visit) {
  for (const layout::Triangle& t : set.triangles) visit(t.number, scene::bounds_of(t));
  primitives::for_each_shape([&](auto kind) {
    for (const auto& s : decltype(kind)::of(set)) visit(s.number, bounds_of(s.shape));
  });
}

// Gives the zero-area triangles (scene/model/zero_area.h) without normals, in all shares, those that they
// have in the whole scene.
void settle_zero_area(PrimitiveSet& set, transport::Together& all);

// How many rows of colours and texture coordinates each triangle has; the same on all ranks.
struct CornerRows {
  std::size_t colors = 0, texcoords = 0;
};

// Brings every primitive to the rank that holds its cell, and returns those that have come to this one.
// `rank_of` has the rank of each of the set's primitives, in the order of for_each_box().
PrimitiveSet bring(PrimitiveSet set, std::span<const std::uint32_t> rank_of, const CornerRows& rows,
                   transport::Together& all);

}  // namespace kdray::partition
