#include "flatten/pieces.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "flatten/leaf_block.h"

namespace kdray::flatten {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// ---- Cutting: weights in double

using Weights = std::array<double, 3>;

// A convex polygon in a triangle. Each of a box's planes adds a corner at most.
struct Polygon {
  std::array<Weights, 9> corner;
  std::size_t n = 0;

  void add(const Weights& w) { corner[n++] = w; }
};

Weights between(const Weights& a, const Weights& b, double t) {
  Weights w;
  for (std::size_t k = 0; k < 3; ++k) w[k] = a[k] + t * (b[k] - a[k]);
  return w;
}

// What is on the inner side: where the weighted sum of the corners' distances is 0 or more. A corner that is
// added may be off along the plane's normal by the rounding of distances, but not off its edge.
Polygon within(const Polygon& from, const Weights& distances) {
  Polygon kept;
  const auto distance = [&](const Weights& w) {
    return w[0] * distances[0] + w[1] * distances[1] + w[2] * distances[2];
  };
  double last = from.n > 0 ? distance(from.corner[from.n - 1]) : 0;
  for (std::size_t i = 0; i < from.n; ++i) {
    const Weights& before = from.corner[(i + from.n - 1) % from.n];
    const double here = distance(from.corner[i]);
    if ((last < 0) != (here < 0)) kept.add(between(before, from.corner[i], last / (last - here)));
    if (here >= 0) kept.add(from.corner[i]);
    last = here;
  }
  return kept;
}

Piece around(const Polygon& polygon) {
  constexpr double kRounding = 0x1p-30;  // of weights: a thousand times what there is
  if (polygon.n == 0) return Piece::nothing();
  Piece piece;
  for (std::size_t k = 0; k < 3; ++k) {
    double lo = 1, hi = 0;
    for (std::size_t i = 0; i < polygon.n; ++i) {
      lo = std::min(lo, polygon.corner[i][k]);
      hi = std::max(hi, polygon.corner[i][k]);
    }
    piece.lo[k] = static_cast<std::uint8_t>(std::clamp(std::floor(256 * (lo - kRounding)), 0.0, 255.0));
    piece.last[k] =
        static_cast<std::uint8_t>(std::clamp(std::ceil(256 * (hi + kRounding)), 1.0, 256.0) - 1);
  }
  return piece;
}

// ---- Moving: floats, all lanes at once

// The corners of a piece's hexagon: for each order (i, j, k) of the weights, the largest first one, then the
// largest second one. Weights are 256ths, of which floats get every sum right.
constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};

template <std::uint32_t kLanes>
using Lanes = std::array<float, kLanes>;

template <std::uint32_t kLanes>
struct Span {  // along one axis
  Lanes<kLanes> lo, hi;
};

template <std::uint32_t kLanes>
Box bounds_of_pieces(const layout::u32* words, const std::uint8_t* pieces, std::uint32_t n) {
  using Row = Lanes<kLanes>;
  std::array<Row, 3> lo, hi;
  for (std::uint32_t k = 0; k < 3; ++k)
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
      lo[k][lane] = static_cast<float>(pieces[k * kLanes + lane]) * 0x1p-8f;
      hi[k][lane] = static_cast<float>(pieces[(3 + k) * kLanes + lane] + 1) * 0x1p-8f;
    }
  std::array<std::array<Row, 3>, 6> weights;
  for (std::size_t o = 0; o < 6; ++o) {
    const auto [i, j, k] = kOrders[o];
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
      const float a = std::min(hi[i][lane], 1 - lo[j][lane] - lo[k][lane]);
      const float b = std::min(hi[j][lane], 1 - a - lo[k][lane]);
      weights[o][i][lane] = a;
      weights[o][j][lane] = b;
      weights[o][k][lane] = 1 - a - b;
    }
  }
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto coordinate = [&](std::uint32_t corner, std::uint32_t lane) {
      return std::bit_cast<float>(words[(3 * corner + static_cast<std::uint32_t>(axis)) * kLanes + lane]);
    };
    Span<kLanes> span;
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
      const float p = coordinate(0, lane), q = coordinate(1, lane), r = coordinate(2, lane);
      float least = kInfinity, most = -kInfinity;
      for (std::size_t o = 0; o < 6; ++o) {
        const float at = weights[o][0][lane] * p + weights[o][1][lane] * q + weights[o][2][lane] * r;
        least = std::min(least, at);
        most = std::max(most, at);
      }
      // A sum of three is off by less than 4u of the largest; and no piece is larger than its triangle.
      const float off = std::max({std::abs(p), std::abs(q), std::abs(r)}) * 0x1p-22f + 0x1p-126f;
      span.lo[lane] = std::max(least - off, std::min({p, q, r}));
      span.hi[lane] = std::min(most + off, std::max({p, q, r}));
    }
    for (std::uint32_t lane = 0; lane < n; ++lane) {
      if (lo[0][lane] > hi[0][lane]) continue;  // nothing
      box.lo[axis] = std::min(box.lo[axis], span.lo[lane]);
      box.hi[axis] = std::max(box.hi[axis], span.hi[lane]);
    }
  }
  return box;
}

}  // namespace

Piece piece_of(const layout::Triangle& t, const Box& box) {
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int v = 0; v < 3; ++v) largest = std::max(largest, std::abs(double{t.v[v][axis]}));
  Polygon polygon;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float a = t.v[0][axis], b = t.v[1][axis], c = t.v[2][axis];
    const auto k = static_cast<int>(axis);
    const bool below = std::min({a, b, c}) < box.lo[k], above = std::max({a, b, c}) > box.hi[k];
    if (!below && !above) continue;
    if (polygon.n == 0) {
      polygon.add({1, 0, 0});
      polygon.add({0, 1, 0});
      polygon.add({0, 0, 1});
    }
    const double lo = box.lo[k] - 0x1p-40 * largest, hi = box.hi[k] + 0x1p-40 * largest;
    if (below) polygon = within(polygon, {a - lo, b - lo, c - lo});
    if (above) polygon = within(polygon, {hi - a, hi - b, hi - c});
    if (polygon.n == 0) return Piece::nothing();
  }
  return polygon.n == 0 ? Piece::whole() : around(polygon);
}

Pieces::Pieces(const WideForm& form, const Array<layout::Triangle>& triangles)
    : block_(static_cast<std::size_t>(form.block)),
      bytes_(form.triangle_blocks.size() / KDRAY_TRIANGLE_ROWS * kRows) {
  constexpr std::size_t kGrain = 256;  // nodes
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, form.nodes.size(), kGrain), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) cut(form, triangles, i);
  });
}

void Pieces::cut(const WideForm& form, const Array<layout::Triangle>& triangles, std::size_t node) {
  const layout::WideNode& at = form.nodes[node];
  const auto block = static_cast<std::uint32_t>(block_);
  for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
    if (!is_leaf_of<primitives::TriangleKind>(at.child[slot])) continue;
    const Box box = bounds_of_child(at, slot);
    std::size_t i = at.child[slot] & KDRAY_WIDE_FIRST_MASK;
    for (LeafBlock b(form.triangle_blocks, i, block);; b = LeafBlock(form.triangle_blocks, ++i, block)) {
      std::uint8_t* const rows = bytes_.data() + i * kRows * block_;
      for (std::uint32_t lane = 0; lane < block; ++lane) {
        const Piece piece = lane < b.n ? piece_of(triangles[b.index(lane)], box) : Piece::nothing();
        for (std::size_t k = 0; k < 3; ++k) {
          rows[k * block + lane] = piece.lo[k];
          rows[(3 + k) * block + lane] = piece.last[k];
        }
      }
      if (b.is_last) break;
    }
  }
}

Box bounds_of_pieces(const layout::u32* words, const std::uint8_t* pieces, std::uint32_t n,
                     std::uint32_t block) {
  return block == 8 ? bounds_of_pieces<8>(words, pieces, n) : bounds_of_pieces<4>(words, pieces, n);
}

}  // namespace kdray::flatten
