#include "accel/flatten/refit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "accel/flatten/leaf_block.h"

namespace kdray::flatten {

namespace {

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

// Returns what is on the inner side: where the weighted sum of the corners' distances is 0 or more. An added
// corner may be off along the plane's normal by the rounding of distances, but not off its edge.
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

// Returns the hexagon around a polygon: all places whose weights are within the polygon's. Its corners have,
// for each order of the weights, the largest first one, then the largest second one.
Polygon hexagon_around(const Polygon& polygon) {
  constexpr std::size_t kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {2, 0, 1}, {2, 1, 0}, {1, 2, 0}, {1, 0, 2}};
  Weights lo{1, 1, 1}, hi{0, 0, 0};
  for (std::size_t i = 0; i < polygon.n; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], polygon.corner[i][k]);
      hi[k] = std::max(hi[k], polygon.corner[i][k]);
    }
  Polygon hexagon;
  for (const auto& [i, j, k] : kOrders) {
    Weights w;
    w[i] = std::min(hi[i], 1 - lo[j] - lo[k]);
    w[j] = std::min(hi[j], 1 - w[i] - lo[k]);
    w[k] = 1 - w[i] - w[j];
    hexagon.add(w);
  }
  return hexagon;
}

std::uint8_t byte_of(double weight) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(weight, 0.0, 1.0)));
}

Piece piece_of(const Polygon& polygon) {
  if (polygon.n == 0) return Piece::nothing();
  if (polygon.n > Piece::kCorners) return piece_of(hexagon_around(polygon));
  Piece piece;
  for (std::size_t i = 0; i < Piece::kCorners; ++i) {
    const Weights& w = polygon.corner[std::min(i, polygon.n - 1)];
    piece.corners[i] = {byte_of(w[1]), byte_of(w[2])};
  }
  return piece;
}

// ---- Moving: floats, all lanes at once

template <std::uint32_t kLanes>
using Lanes = std::array<float, kLanes>;

// An interval along one axis, for each lane.
template <std::uint32_t kLanes>
struct Span {
  Lanes<kLanes> lo, hi;
};

template <std::uint32_t kLanes>
using Weighted = std::array<std::array<Lanes<kLanes>, 2>, Piece::kCorners>;

template <std::uint32_t kLanes>
Weighted<kLanes> weights_of(const std::uint8_t* pieces) {
  Weighted<kLanes> weights;
  for (auto& corner : weights)
    for (Lanes<kLanes>& row : corner)
      for (float& weight : row) weight = static_cast<float>(*pieces++) * (1.0f / 255);
  return weights;
}

// A weight is off by half a 255th, and by the rounding of floats; a sum of three products by less than 8u of
// the largest term. But no piece is larger than its triangle, which is what makes whole ones exact.
template <std::uint32_t kLanes>
Span<kLanes> span_of(const Weighted<kLanes>& weights, const layout::u32* words, std::size_t axis) {
  constexpr float kByte = 0.5f / 255 * 1.001f;
  const auto coordinate = [&](std::size_t corner, std::uint32_t lane) {
    return std::bit_cast<float>(words[(3 * corner + axis) * kLanes + lane]);
  };
  Span<kLanes> span;
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    const float p = coordinate(0, lane), q = coordinate(1, lane), r = coordinate(2, lane);
    const float e = q - p, f = r - p;
    float least = 0x1p127f, most = -0x1p127f;
    for (const auto& w : weights) {
      const float at = p + (w[0][lane] * e + w[1][lane] * f);
      least = std::min(least, at);
      most = std::max(most, at);
    }
    const float largest = std::max(std::max(std::abs(p), std::abs(q)), std::abs(r));
    const float off = kByte * (std::abs(e) + std::abs(f)) + (largest * 0x1p-20f + 0x1p-126f);
    span.lo[lane] = std::max(least - off, std::min(std::min(p, q), r));
    span.hi[lane] = std::min(most + off, std::max(std::max(p, q), r));
  }
  return span;
}

template <std::uint32_t kLanes>
Box bounds_of_pieces(const layout::u32* words, const std::uint8_t* pieces, std::uint32_t n) {
  const Weighted<kLanes> weights = weights_of<kLanes>(pieces);
  Box box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Span<kLanes> span = span_of<kLanes>(weights, words, axis);
    const auto k = static_cast<int>(axis);
    for (std::uint32_t lane = 0; lane < n; ++lane) {
      if (pieces[lane] == Piece::kNowhere && pieces[kLanes + lane] == Piece::kNowhere) continue;
      box.lo[k] = std::min(box.lo[k], span.lo[lane]);
      box.hi[k] = std::max(box.hi[k], span.hi[lane]);
    }
  }
  return box;
}

}  // namespace

Piece Piece::nothing() {
  Piece piece;
  piece.corners.fill({kNowhere, kNowhere});
  return piece;
}

Piece piece_of(const TriangleInBlock& t, const Box& box) {
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int v = 0; v < 3; ++v) largest = std::max(largest, std::abs(double{t(v, axis)}));
  Polygon polygon;
  for (int axis = 0; axis < 3; ++axis) {
    const float a = t(0, axis), b = t(1, axis), c = t(2, axis);
    const bool below = std::min({a, b, c})<box.lo[axis], above = std::max({a, b, c})> box.hi[axis];
    if (!below && !above) continue;
    if (polygon.n == 0) {
      polygon.add({1, 0, 0});
      polygon.add({0, 1, 0});
      polygon.add({0, 0, 1});
    }
    const double lo = box.lo[axis] - 0x1p-40 * largest, hi = box.hi[axis] + 0x1p-40 * largest;
    if (below) polygon = within(polygon, {a - lo, b - lo, c - lo});
    if (above) polygon = within(polygon, {hi - a, hi - b, hi - c});
    if (polygon.n == 0) return Piece::nothing();
  }
  return polygon.n == 0 ? Piece::whole() : piece_of(polygon);
}

Pieces::Pieces(const WideForm& form)
    : block_(static_cast<std::size_t>(form.block)),
      bytes_(form.triangle_blocks.size() / KDRAY_TRIANGLE_ROWS * kRows) {
  constexpr std::size_t kGrain = 256;  // nodes
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, form.nodes.size(), kGrain), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      for (std::uint32_t slot = 0; slot < kWidth; ++slot)
        if (is_leaf_of<primitives::TriangleKind>(form.nodes[i].child[slot]))
          cut_leaf(form, form.nodes[i].child[slot], bounds_of_child(form.nodes[i], slot));
  });
}

void Pieces::cut_leaf(const WideForm& form, layout::u32 leaf, const Box& box) {
  const auto block = static_cast<std::uint32_t>(block_);
  bool more = true;
  for (std::size_t i = leaf & KDRAY_WIDE_FIRST_MASK; more; ++i) {
    const LeafBlock at(form.triangle_blocks, i, block);
    std::uint8_t* const rows = bytes_.data() + i * kRows * block_;
    for (std::uint32_t lane = 0; lane < block; ++lane) {
      const Piece piece =
          lane < at.n ? piece_of(TriangleInBlock{at.words + lane, block}, box) : Piece::nothing();
      for (std::size_t c = 0; c < Piece::kCorners; ++c)
        for (std::size_t k = 0; k < 2; ++k) rows[(2 * c + k) * block + lane] = piece.corners[c][k];
    }
    more = !at.is_last;
  }
}

Box bounds_of_pieces(const layout::u32* words, const std::uint8_t* pieces, std::uint32_t n,
                     std::uint32_t block) {
  return block == 8 ? bounds_of_pieces<8>(words, pieces, n) : bounds_of_pieces<4>(words, pieces, n);
}

}  // namespace kdray::flatten
