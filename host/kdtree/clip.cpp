#include "kdtree/clip.h"

namespace kdray::kdtree {

SplitBounds clip_to_sides(const scene::Geometry& geometry, const BoundedRef& r, const Bounds& cell, int axis,
                          float position) {
  const Bounds known = r.bounds();
  const std::uint32_t index = ref_index(r.ref);
  switch (ref_kind(r.ref)) {
    case scene::PrimitiveKind::triangle:
      return clip_triangle(geometry.triangles[index], known, cell, axis, position);
    case scene::PrimitiveKind::sphere:
      return {clip_sphere(geometry.spheres[index], below(known, axis, position)),
              clip_sphere(geometry.spheres[index], above(known, axis, position))};
    case scene::PrimitiveKind::cone:
      return {clip_cone(geometry.cones[index], below(known, axis, position)),
              clip_cone(geometry.cones[index], above(known, axis, position))};
  }
  return {below(known, axis, position), above(known, axis, position)};
}

}  // namespace kdray::kdtree
