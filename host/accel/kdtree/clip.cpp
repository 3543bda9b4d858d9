#include "accel/kdtree/clip.h"

namespace kdray::kdtree {

SplitBounds clip_to_sides(const scene::Geometry& geometry, const BoundedRef& r, const Bounds& cell, int axis,
                          float position) {
  const Bounds known = r.bounds();
  const std::uint32_t index = ref_index(r.ref);
  return primitives::with_kind(kind_number(r.ref), [&](auto kind) -> SplitBounds {
    const auto& primitive = decltype(kind)::of(geometry)[index];
    if constexpr (decltype(kind)::kIsShape)
      return {clip(primitive, below(known, axis, position)), clip(primitive, above(known, axis, position))};
    else
      return clip_triangle(primitive, known, cell, axis, position);
  });
}

}  // namespace kdray::kdtree
