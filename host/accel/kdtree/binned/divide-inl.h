// What    Hands a cell's references to the two sides of a plane, without branches: each is written to all
//         three places, and one of the places moves on. What straddles is clipped into both.
// Shape   A reference that ends at the plane or lies in it is below, one that begins there is above: at most
//         one side gets it. In clipping lanes are axes: the part of a triangle on one side of the plane is
//         spanned by its vertices there and the points where its edges cross the plane. Bounds of these,
//         padded for rounding, are intersected with the bounds known before.
// Error   A crossing a + t(b - a) in floats, t = (s - a_x)/(b_x - a_x) in [0, 1]: t has relative error 3u,
//         (b - a) and the product u each, the sum u of itself; in all at most 5.1u|b - a| + u|p|, and taking
//         the pad away adds u|p|. The pad is 8u|b - a| + 4u|p| + 2^-140 (u = 2^-24; the last for what
//         underflows). docs/design/clipping.md.
#if defined(KDRAY_BINNED_DIVIDE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KDRAY_BINNED_DIVIDE_INL_H
#undef KDRAY_BINNED_DIVIDE_INL_H
#else
#define KDRAY_BINNED_DIVIDE_INL_H
#endif

#include "accel/kdtree/binned/binned.h"
#include "accel/kdtree/binned/cost-inl.h"
#include "accel/kdtree/clip.h"
#include "hwy/cache_control.h"

HWY_BEFORE_NAMESPACE();
namespace kdray::kdtree::binned::HWY_NAMESPACE {

using Axes = hn::Full128<float>;  // x, y, z, and a lane that nothing reads
using P = hn::Vec<Axes>;
using OnAxes = hn::Mask<Axes>;

struct Span {
  P lo, hi;
  HWY_ATTR void include(OnAxes which, P from, P to) {
    lo = hn::IfThenElse(which, hn::Min(lo, from), lo);
    hi = hn::IfThenElse(which, hn::Max(hi, to), hi);
  }
};

// What is left of a triangle on both sides of the plane. Along the plane's own axis the spans are of no use.
struct Parts {
  Span below, above;
};

HWY_ATTR inline Parts parts_of(const scene::TriangleGeometry& triangle, const Plane& plane) {
  const Axes d;
  const P s = hn::Set(d, plane.position), inf = hn::Inf(d);
  const Span none{inf, hn::Neg(inf)};
  Parts parts{none, none};
  P x[3], corner[3];
  for (int v = 0; v < 3; ++v) {
    const float* const p = triangle.v[v];
    x[v] = hn::Set(d, p[plane.axis]);
    // The fourth float is part of the triangle too; left in, it could be slow (a denormal).
    corner[v] = hn::IfThenElseZero(hn::FirstN(d, 3), hn::LoadU(d, p));
    parts.below.include(hn::Le(x[v], s), corner[v], corner[v]);
    parts.above.include(hn::Ge(x[v], s), corner[v], corner[v]);
  }
  Span crossings = none;
  for (int v = 0; v < 3; ++v) {
    const int w = v == 2 ? 0 : v + 1;
    const P t = hn::Div(hn::Sub(s, x[v]), hn::Sub(x[w], x[v]));
    const P edge = hn::Sub(corner[w], corner[v]);
    const P p = hn::Add(corner[v], hn::Mul(t, edge));
    const P pad = hn::Add(
        hn::Add(hn::Mul(hn::Abs(edge), hn::Set(d, 0x1p-21f)), hn::Mul(hn::Abs(p), hn::Set(d, 0x1p-22f))),
        hn::Set(d, 0x1p-140f));
    crossings.include(hn::Xor(hn::Lt(x[v], s), hn::Lt(x[w], s)), hn::Sub(p, pad), hn::Add(p, pad));
  }
  for (Span* const part : {&parts.below, &parts.above}) {
    part->lo = hn::Min(part->lo, crossings.lo);
    part->hi = hn::Max(part->hi, crossings.hi);
  }
  return parts;
}

// Writes the reference of a part, whose number lies in the fourth lane of `lo`. Returns whether there is
// anything in it.
HWY_ATTR inline bool store_part(P lo, P hi, BoundedRef& out) {
  const Axes d;
  hn::Store(lo, d, out.lo.data());
  hn::Store(hi, d, out.hi.data());
  return hn::AllTrue(d, hn::Or(hn::Le(lo, hi), hn::Not(hn::FirstN(d, 3))));
}

// Clips `r`, a reference of that triangle that straddles the plane, and appends to both sides.
HWY_ATTR inline void clip_triangle(const scene::TriangleGeometry& triangle, const BoundedRef& r,
                                   const Plane& plane, BoundedRef* below, BoundedRef* above, Divided& sides) {
  const Axes d;
  const hn::RebindToSigned<Axes> di;
  const P s = hn::Set(d, plane.position), lo = hn::Load(d, r.lo.data()), hi = hn::Load(d, r.hi.data());
  const auto lane = hn::Iota(di, 0);
  const OnAxes across = hn::RebindMask(d, hn::Eq(lane, hn::Set(di, plane.axis)));
  const OnAxes kept = hn::Or(across, hn::RebindMask(d, hn::Eq(lane, hn::Set(di, 3))));
  const Parts parts = parts_of(triangle, plane);
  const auto cut_lo = [&](P part) HWY_ATTR { return hn::IfThenElse(kept, lo, hn::Max(part, lo)); };
  const auto cut_hi = [&](P part) HWY_ATTR { return hn::IfThenElse(kept, hi, hn::Min(part, hi)); };
  sides.n_below += store_part(cut_lo(parts.below.lo), hn::IfThenElse(across, s, cut_hi(parts.below.hi)),
                              below[sides.n_below]);
  sides.n_above += store_part(hn::IfThenElse(across, s, cut_lo(parts.above.lo)), cut_hi(parts.above.hi),
                              above[sides.n_above]);
}

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

// Return the side of a reference as a number: a branch would be mispredicted for every other one.
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

// Sorts references by side. `below` or `above` may be where the references are; each place has space for all
// and one more.
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

// Moves the triangles to the front and returns their number.
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
    // The triangles lie anywhere in memory, so all are prefetched before the first is needed.
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
