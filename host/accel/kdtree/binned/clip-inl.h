// What    Bounds of the two parts of a triangle that straddles a plane. Lanes are axes.
// Shape   The part of a triangle on one side of the plane is spanned by its vertices there and the points
//         where its edges cross the plane. Bounds of these, padded for rounding, are cut with the bounds
//         known before: what both contain.
// Error   A crossing a + t(b - a) in floats, t = (s - a_x)/(b_x - a_x) in [0, 1]: t has relative error 3u, b
//         - a and the product u each, the sum u of itself; in all at most 5.1u|b - a| + u|p|, and taking the
//           pad away adds u|p|. The pad
//         is 8u|b - a| + 4u|p| + 2^-140 (u = 2^-24; the last for what underflows). docs/design/clipping.md.
#if defined(KDRAY_BINNED_CLIP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KDRAY_BINNED_CLIP_INL_H
#undef KDRAY_BINNED_CLIP_INL_H
#else
#define KDRAY_BINNED_CLIP_INL_H
#endif

#include "accel/kdtree/binned/cost-inl.h"
#include "accel/kdtree/binned/simd.h"

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

// The reference of a part; its number lies in the fourth lane of `lo`. Whether there is anything in it.
HWY_ATTR inline bool store_part(P lo, P hi, BoundedRef& out) {
  const Axes d;
  hn::Store(lo, d, out.lo.data());
  hn::Store(hi, d, out.hi.data());
  return hn::AllTrue(d, hn::Or(hn::Le(lo, hi), hn::Not(hn::FirstN(d, 3))));
}

// `r` is of that triangle, which straddles the plane. Appends to both sides.
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

}  // namespace kdray::kdtree::binned::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
