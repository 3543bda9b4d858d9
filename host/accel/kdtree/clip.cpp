// What    The bounds of a triangle on both sides of a plane inside a cell: Sutherland and Hodgman's clipping
//         in double.
// Shape   The original triangle is clipped against the cell widened by kWiden*M, M its largest coordinate;
//         the polygon is bounded, widened by the same and rounded outward to float. A computed crossing is
//         off by less than 16*2^-53*M and at most seven planes follow each other, so the error stays below
//         112*2^-53*M < kWiden*M (docs/design/clipping.md). An empty polygon is therefore a proof. Shapes
//         have their own clipping (primitives/<kind>.cpp).

#include "accel/kdtree/clip.h"

#include <cmath>

#include "base/box.h"

namespace kdray::kdtree {

namespace {

constexpr double kWiden = 0x1p-45;

struct Polygon {
  int n = 0;
  double p[10][3];  // each of seven planes adds at most one corner to the three

  void add(const double* q) {
    p[n][0] = q[0], p[n][1] = q[1], p[n][2] = q[2];
    ++n;
  }
};

// Keeps the part with sign*x <= sign*plane.
template <int kSign>
void clip(const Polygon& in, int axis, double plane, Polygon& out) {
  out.n = 0;
  const auto is_inside = [&](const double* q) { return kSign > 0 ? q[axis] <= plane : q[axis] >= plane; };
  const double* previous = in.p[in.n - 1];
  bool previous_inside = is_inside(previous);
  for (int i = 0; i < in.n; ++i) {
    const double* current = in.p[i];
    const bool current_inside = is_inside(current);
    if (current_inside != previous_inside) {
      // Always from the inside to the outside, so that neighbours find the same point on a shared edge.
      const double* a = previous_inside ? previous : current;
      const double* b = previous_inside ? current : previous;
      const double t = (plane - a[axis]) / (b[axis] - a[axis]);
      double q[3];
      for (int k = 0; k < 3; ++k) q[k] = a[k] + t * (b[k] - a[k]);
      q[axis] = plane;
      out.add(q);
    }
    if (current_inside) out.add(current);
    previous = current;
    previous_inside = current_inside;
  }
}

void range(const Polygon& polygon, int axis, double& lo, double& hi) {
  lo = hi = polygon.p[0][axis];
  for (int i = 1; i < polygon.n; ++i) {
    lo = std::min(lo, polygon.p[i][axis]);
    hi = std::max(hi, polygon.p[i][axis]);
  }
}

// Clips to the cell's six planes; only those that the polygon crosses cost anything.
void clip_to_cell(const Bounds& cell, double widen, Polygon& polygon) {
  Polygon other;
  for (int axis = 0; axis < 3 && polygon.n > 0; ++axis) {
    const double cell_lo = cell.lo[axis] - widen, cell_hi = cell.hi[axis] + widen;
    double lo, hi;
    range(polygon, axis, lo, hi);
    if (lo < cell_lo) {
      clip<-1>(polygon, axis, cell_lo, other);
      polygon = other;
      if (polygon.n == 0) return;
    }
    if (hi > cell_hi) {
      clip<+1>(polygon, axis, cell_hi, other);
      polygon = other;
    }
  }
}

Bounds bounds_of_polygon(const Polygon& polygon, double widen, const Bounds& region) {
  if (polygon.n == 0) return no_bounds();
  Bounds b;
  for (int axis = 0; axis < 3; ++axis) {
    double lo, hi;
    range(polygon, axis, lo, hi);
    b.lo[axis] = round_down(lo - widen);
    b.hi[axis] = round_up(hi + widen);
  }
  return intersection(b, region);
}

}  // namespace

SplitBounds clip_triangle(const scene::TriangleGeometry& t, const Bounds& known, const Bounds& cell, int axis,
                          float position) {
  Polygon polygon, side;
  double largest = 0;
  polygon.n = 3;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      polygon.p[i][k] = t.v[i][k];
      largest = std::max(largest, std::abs(polygon.p[i][k]));
    }
  }
  const double widen = kWiden * largest;
  clip_to_cell(cell, widen, polygon);
  if (polygon.n == 0) return {no_bounds(), no_bounds()};
  SplitBounds result;
  clip<+1>(polygon, axis, position + widen, side);
  result.below = bounds_of_polygon(side, widen, below(known, axis, position));
  clip<-1>(polygon, axis, position - widen, side);
  result.above = bounds_of_polygon(side, widen, above(known, axis, position));
  return result;
}

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
