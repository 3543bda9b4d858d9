// What    Hands a cell's references to the two sides of a plane, without branches: each is written to all
//         three places, and one of the places moves on.
// Shape   A reference that ends at the plane or lies in it is below, one that begins there is above: at most
//         one side gets it. What straddles is clipped into both.
#if defined(KDRAY_BINNED_DIVIDE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KDRAY_BINNED_DIVIDE_INL_H
#undef KDRAY_BINNED_DIVIDE_INL_H
#else
#define KDRAY_BINNED_DIVIDE_INL_H
#endif

#include "accel/kdtree/binned/clip-inl.h"
#include "accel/kdtree/clip.h"
#include "hwy/cache_control.h"

HWY_BEFORE_NAMESPACE();
namespace kdray::kdtree::binned::HWY_NAMESPACE {

HWY_ATTR inline Bounds hull_of_refs(std::span<const BoundedRef> refs) {
  const hn::Full128<float> d;
  auto lo = hn::Inf(d);
  auto hi = hn::Neg(lo);
  for (const BoundedRef& r : refs) {
    lo = hn::Min(lo, hn::Load(d, r.lo.data()));
    hi = hn::Max(hi, hn::Load(d, r.hi.data()));
  }
  alignas(16) std::array<float, 4> l, h;
  hn::Store(lo, d, l.data());
  hn::Store(hi, d, h.data());
  return {{l[0], l[1], l[2]}, {h[0], h[1], h[2]}};
}

struct Sorted {
  std::size_t n_below = 0, n_above = 0, n_straddling = 0;
};

// Copies a reference in one piece, where vectors are wide enough.
HWY_ATTR inline void copy_ref(const BoundedRef& from, BoundedRef* to) {
  const hn::CappedTag<float, 8> d;
  const float* const in = from.lo.data();
  float* const out = to->lo.data();
  for (std::size_t i = 0; i < 8; i += hn::Lanes(d)) hn::StoreU(hn::LoadU(d, in + i), d, out + i);
}

// The side of a reference as a number: a branch would be mispredicted for every other one.
inline std::size_t is_below(const BoundedRef& r, std::size_t axis, float position) {
  return r.hi[axis] <= position ? 1 : 0;
}
inline std::size_t is_above(const BoundedRef& r, std::size_t axis, float position) {
  return (r.lo[axis] >= position ? 1 : 0) & (is_below(r, axis, position) ^ 1);
}

HWY_ATTR inline std::size_t count_straddling(std::span<const BoundedRef> refs, const Plane& plane) {
  const auto k = static_cast<std::size_t>(plane.axis);
  std::size_t n = refs.size();
  for (const BoundedRef& r : refs) n -= is_below(r, k, plane.position) + is_above(r, k, plane.position);
  return n;
}

// `below` or `above` may be where the references are; each place has room for all and one more.
HWY_ATTR inline Sorted sort_sides(const BoundedRef* refs, std::size_t n, const Plane& plane,
                                  BoundedRef* below, BoundedRef* above, BoundedRef* straddling) {
  const auto k = static_cast<std::size_t>(plane.axis);
  Sorted sorted;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t below_it = is_below(refs[i], k, plane.position);
    const std::size_t above_it = is_above(refs[i], k, plane.position);
    const BoundedRef r = refs[i];
    copy_ref(r, below + sorted.n_below);
    copy_ref(r, above + sorted.n_above);
    copy_ref(r, straddling + sorted.n_straddling);
    sorted.n_below += below_it;
    sorted.n_above += above_it;
    sorted.n_straddling += 1 - below_it - above_it;
  }
  return sorted;
}

// Puts both parts of a straddling reference of any kind behind the others.
inline void clip_one(const scene::Geometry& geometry, const BuildConfig& config, const BoundedRef& r,
                     const Plane& plane, BoundedRef* below_refs, BoundedRef* above_refs, Divided& sides) {
  const Bounds known = r.bounds();
  const SplitBounds parts = config.clip ? clip_to_sides(geometry, r, known, plane.axis, plane.position)
                                        : SplitBounds{below(known, plane.axis, plane.position),
                                                      above(known, plane.axis, plane.position)};
  if (!parts.below.empty()) below_refs[sides.n_below++] = with_bounds(r, parts.below);
  if (!parts.above.empty()) above_refs[sides.n_above++] = with_bounds(r, parts.above);
}

// Moves the triangles to the front; their number.
inline std::size_t triangles_first(std::span<BoundedRef> refs) {
  const auto others = std::partition(refs.begin(), refs.end(), [](const BoundedRef& r) {
    return ref_kind(r.ref) == scene::PrimitiveKind::triangle;
  });
  return static_cast<std::size_t>(others - refs.begin());
}

HWY_ATTR inline void clip_straddling(const scene::Geometry& geometry, const BuildConfig& config,
                                     std::span<BoundedRef> refs, const Plane& plane, BoundedRef* below,
                                     BoundedRef* above, Divided& sides) {
  std::size_t n_triangles = 0;
  if (config.clip) {
    const bool mixed = geometry.size() > geometry.triangles.size();
    n_triangles = mixed ? triangles_first(refs) : refs.size();
    // The triangles lie anywhere in memory, so all are on their way before the first is needed.
    for (const BoundedRef& r : refs.first(n_triangles)) hwy::Prefetch(&geometry.triangles[ref_index(r.ref)]);
    for (const BoundedRef& r : refs.first(n_triangles))
      clip_triangle(geometry.triangles[ref_index(r.ref)], r, plane, below, above, sides);
  }
  for (const BoundedRef& r : refs.subspan(n_triangles))
    clip_one(geometry, config, r, plane, below, above, sides);
}

}  // namespace kdray::kdtree::binned::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
