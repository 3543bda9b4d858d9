#include "cluster/partition/primitive_set.h"

namespace kdray::partition {

namespace {

// Of an array that has none, or as many for each of n triangles.
template <class T>
void add_rows(RawVector<T>& rows, const Array<T>& all, std::size_t n, const Slice& slice) {
  const std::size_t each = n == 0 ? 0 : all.size() / n;
  rows.insert(rows.end(), all.begin() + slice.first * each, all.begin() + slice.last * each);
}

bool is_bare(const scene::Scene& scene, const scene::Geometry& geometry, std::size_t i) {
  return scene::is_zero_area(geometry.triangles[i]) &&
         scene.triangles[geometry.sources[i]].normal[0] == scene::kNone;
}

void add_triangles(PrimitiveSet& set, const scene::Scene& scene, const scene::Geometry& geometry,
                   const flatten::FlatScene& flat, const Slice& slice) {
  for (std::size_t i = slice.first; i < slice.last; ++i) {
    layout::Triangle t = flat.triangles[i];
    if (is_bare(scene, geometry, i))
      set.bare_zero_area.push_back(static_cast<std::uint32_t>(set.triangles.size()));
    if (t.normals != KDRAY_NO_NORMALS) {
      const auto place = static_cast<layout::u32>(set.normals.size());
      set.normals.push_back(flat.normals[t.normals & KDRAY_NORMALS_MASK]);
      t.normals = (t.normals & KDRAY_ZERO_AREA) | place;
    }
    set.triangles.push_back(t);
  }
  add_rows(set.colors, flat.corner_colors, flat.triangles.size(), slice);
  add_rows(set.texcoords, flat.texcoords, flat.triangles.size(), slice);
}

}  // namespace

void add_slice(PrimitiveSet& set, const scene::Scene& scene, const scene::Geometry& geometry,
               const flatten::FlatScene& flat, int rank, int size) {
  add_triangles(set, scene, geometry, flat, slice_of(flat.triangles.size(), rank, size));
  primitives::for_each_shape([&](auto kind) {
    using Kind = decltype(kind);
    const auto& shapes = Kind::of(geometry);
    const Slice slice = slice_of(shapes.size(), rank, size);
    for (std::size_t i = slice.first; i < slice.last; ++i) {
      const auto& packed = Kind::of(flat)[i];
      Kind::of(set).push_back({shapes[i], packed.number, packed.material});
    }
  });
}

}  // namespace kdray::partition
