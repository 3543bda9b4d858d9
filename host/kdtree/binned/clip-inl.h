// What    Bounds of the two parts of triangles that straddle a plane, as many triangles at once as a vector has lanes.
// Shape   The part of a triangle on one side of the plane is spanned by its vertices there and the points where its edges
//         cross the plane. Bounds of these, padded for rounding, are cut with the bounds known before: what both contain.
// Error   A crossing a + t(b - a) in floats, t = (s - a_x)/(b_x - a_x) in [0, 1]: t has relative error 3u, b - a and the
//         product u each, the sum u of itself; in all at most 5.1u|b - a| + u|p|, and taking the pad away adds u|p|. The pad
//         is 8u|b - a| + 4u|p| + 2^-140 (u = 2^-24; the last for what underflows). docs/design/kdtree.md.
#if defined(KDRAY_BINNED_CLIP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KDRAY_BINNED_CLIP_INL_H
#undef KDRAY_BINNED_CLIP_INL_H
#else
#define KDRAY_BINNED_CLIP_INL_H
#endif

#include "kdtree/binned/cost-inl.h"
#include "kdtree/binned/simd.h"

HWY_BEFORE_NAMESPACE();
namespace kdray::kdtree::binned::HWY_NAMESPACE {

// Triangles and their known bounds side by side; axes in the order split axis, next, next but one.
struct ClipBatch {
  alignas(64) float vertex[3][3][kMostLanes];  // [vertex][axis]
  alignas(64) float lo[3][kMostLanes], hi[3][kMostLanes];
};

struct Span {
  V lo, hi;
  HWY_ATTR void include(hn::Mask<Floats> which, V from, V to) {
    lo = hn::IfThenElse(which, hn::Min(lo, from), lo);
    hi = hn::IfThenElse(which, hn::Max(hi, to), hi);
  }
};

HWY_ATTR inline Span empty_span() {
  const Floats d;
  const float inf = std::numeric_limits<float>::infinity();
  return {hn::Set(d, inf), hn::Set(d, -inf)};
}

inline void load_triangle(const scene::TriangleGeometry& t, const BoundedRef& r, int axis, std::size_t lane,
                          ClipBatch& batch) {
  for (int k = 0; k < 3; ++k) {
    const int a = axis + k < 3 ? axis + k : axis + k - 3;
    for (std::size_t v = 0; v < 3; ++v) batch.vertex[v][k][lane] = t.vertex[v][a];
    batch.lo[k][lane] = r.lo[static_cast<std::size_t>(a)];
    batch.hi[k][lane] = r.hi[static_cast<std::size_t>(a)];
  }
}

// The parts' extents across the plane, along both other axes.
struct Parts {
  Span below[2], above[2];
};

HWY_ATTR inline Parts parts_of(const ClipBatch& batch, float position) {
  const Floats d;
  const V s = hn::Set(d, position);
  Parts parts{{empty_span(), empty_span()}, {empty_span(), empty_span()}};
  V x[3], y[2][3];
  for (std::size_t v = 0; v < 3; ++v) {
    x[v] = hn::Load(d, batch.vertex[v][0]);
    for (std::size_t j = 0; j < 2; ++j) {
      y[j][v] = hn::Load(d, batch.vertex[v][j + 1]);
      parts.below[j].include(hn::Le(x[v], s), y[j][v], y[j][v]);
      parts.above[j].include(hn::Ge(x[v], s), y[j][v], y[j][v]);
    }
  }
  for (std::size_t v = 0; v < 3; ++v) {
    const std::size_t w = v == 2 ? 0 : v + 1;
    const auto crosses = hn::Xor(hn::Lt(x[v], s), hn::Lt(x[w], s));
    const V t = hn::Div(hn::Sub(s, x[v]), hn::Sub(x[w], x[v]));
    for (std::size_t j = 0; j < 2; ++j) {
      const V edge = hn::Sub(y[j][w], y[j][v]);
      const V p = hn::Add(y[j][v], hn::Mul(t, edge));
      const V pad = hn::Add(
          hn::Add(hn::Mul(hn::Abs(edge), hn::Set(d, 0x1p-21f)), hn::Mul(hn::Abs(p), hn::Set(d, 0x1p-22f))),
          hn::Set(d, 0x1p-140f));
      const V from = hn::Sub(p, pad), to = hn::Add(p, pad);
      parts.below[j].include(crosses, from, to);
      parts.above[j].include(crosses, from, to);
    }
  }
  return parts;
}

// Bounds of a batch's parts on one side, axes in the batch's order.
struct SideBounds {
  alignas(64) float lo[3][kMostLanes], hi[3][kMostLanes];
};

HWY_ATTR inline void cut_known(const ClipBatch& batch, const Span (&part)[2], SideBounds& out) {
  const Floats d;
  for (std::size_t j = 0; j < 2; ++j) {
    hn::Store(hn::Max(part[j].lo, hn::Load(d, batch.lo[j + 1])), d, out.lo[j + 1]);
    hn::Store(hn::Min(part[j].hi, hn::Load(d, batch.hi[j + 1])), d, out.hi[j + 1]);
  }
}

// Writes the parts that are not empty; the number written.
inline std::size_t store_parts(const SideBounds& side, std::span<const BoundedRef> refs, int axis,
                               BoundedRef* out) {
  std::size_t n = 0;
  for (std::size_t lane = 0; lane < refs.size(); ++lane) {
    BoundedRef& r = out[n];
    r.ref = refs[lane].ref;
    bool some = true;
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(axis + k < 3 ? axis + k : axis + k - 3);
      r.lo[a] = side.lo[k][lane];
      r.hi[a] = side.hi[k][lane];
      some &= r.lo[a] <= r.hi[a];
    }
    n += some;
  }
  return n;
}

// `refs` are triangles that straddle the plane; at most as many as lanes. Appends to both sides.
HWY_ATTR inline void clip_batch(const scene::Geometry& geometry, std::span<const BoundedRef> refs,
                                const Plane& plane, BoundedRef* below, BoundedRef* above, Divided& sides) {
  const Floats d;
  ClipBatch batch;
  for (std::size_t lane = 0; lane < refs.size(); ++lane)
    load_triangle(geometry.triangles[ref_index(refs[lane].ref)], refs[lane], plane.axis, lane, batch);
  const Parts parts = parts_of(batch, plane.position);
  SideBounds side;
  cut_known(batch, parts.below, side);
  hn::Store(hn::Load(d, batch.lo[0]), d, side.lo[0]);
  hn::Store(hn::Set(d, plane.position), d, side.hi[0]);
  sides.n_below += store_parts(side, refs, plane.axis, below + sides.n_below);
  cut_known(batch, parts.above, side);
  hn::Store(hn::Set(d, plane.position), d, side.lo[0]);
  hn::Store(hn::Load(d, batch.hi[0]), d, side.hi[0]);
  sides.n_above += store_parts(side, refs, plane.axis, above + sides.n_above);
}

HWY_ATTR inline void clip_triangles(const scene::Geometry& geometry, std::span<const BoundedRef> refs,
                                    const Plane& plane, BoundedRef* below, BoundedRef* above,
                                    Divided& sides) {
  const std::size_t n_lanes = hn::Lanes(Floats());
  for (std::size_t i = 0; i < refs.size(); i += n_lanes)
    clip_batch(geometry, refs.subspan(i, std::min(n_lanes, refs.size() - i)), plane, below, above, sides);
}

}  // namespace kdray::kdtree::binned::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
