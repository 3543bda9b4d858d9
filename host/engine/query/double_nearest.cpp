#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <tuple>
#include <utility>

#include "engine/query/double_scene.h"
#include "engine/query/surface.h"
#include "engine/query/wide_boxes.h"
#include "scene/primitives/shapes.h"

namespace kdray::query {

namespace {

using layout::WideNode;

// Calls visit(rows, n, block) for each block of a leaf of triangles, of which the first n lanes are there,
// until a call answers false; whether none did.
template <class Visit>
bool visit_blocks(const flatten::WideForm& wide, std::uint32_t leaf, const Visit& visit) {
  const auto block = static_cast<std::size_t>(wide.block);
  constexpr std::size_t kRows = KDRAY_TRIANGLE_ROWS;
  const layout::u32* rows = wide.triangle_blocks.data() + (leaf & KDRAY_WIDE_FIRST_MASK) * kRows * block;
  for (;; rows += kRows * block) {
    const layout::u32* const index = rows + (kRows - 1) * block;
    std::size_t n = 0;
    while (n < block && !(index[n] & KDRAY_WIDE_LAST)) ++n;
    const bool is_last = n < block;
    if (is_last) ++n;
    if (!visit(rows, n)) return false;
    if (is_last) return true;
  }
}

// The point of a triangle that is nearest to 0, by weights of its second and third corner. An edge is looked
// at from its lesser corner, whichever triangle asks: of two that share what is nearest both have the same
// distance.
struct NearPoint {
  double square;
  dvec3 point;
  double u, v;
};

NearPoint near_of_edge(const ExactLine::Corners& corners, int i, int k) {
  const auto less = [](const dvec3& a, const dvec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  if (less(corners[static_cast<std::size_t>(k)], corners[static_cast<std::size_t>(i)])) std::swap(i, k);
  const dvec3 &a = corners[static_cast<std::size_t>(i)], &b = corners[static_cast<std::size_t>(k)];
  const dvec3 e = b - a;
  const double length2 = glm::dot(e, e);
  const double s = length2 > 0 ? std::clamp(-glm::dot(a, e) / length2, 0.0, 1.0) : 0;
  const dvec3 point = s == 1 ? b : a + s * e;
  std::array<double, 3> weights{};
  weights[static_cast<std::size_t>(i)] = 1 - s;
  weights[static_cast<std::size_t>(k)] = s;
  return {glm::dot(point, point), point, weights[1], weights[2]};
}

NearPoint near_of(const ExactLine::Corners& corners) {
  const auto& [a, b, c] = corners;
  const dvec3 ab = b - a, bc = c - b, ca = a - c, n = glm::cross(ab, -ca);
  const double n2 = glm::dot(n, n);
  const double wa = glm::dot(glm::cross(b, bc), n), wb = glm::dot(glm::cross(c, ca), n),
               wc = glm::dot(glm::cross(a, ab), n);
  if (n2 > 0 && wa > 0 && wb > 0 && wc > 0) {
    const double height = glm::dot(a, n);
    return {height * (height / n2), height / n2 * n, wb / n2, wc / n2};
  }
  NearPoint best = near_of_edge(corners, 0, 1);
  for (const auto& [i, k] : {std::pair{1, 2}, std::pair{2, 0}})
    if (const NearPoint other = near_of_edge(corners, i, k); other.square < best.square) best = other;
  return best;
}

// The square of the distance from a place to each of eight boxes, or infinity where there is none.
void squares_to_boxes(const WideNode& node, const dvec3& place, double margin, float (&squares)[8]) {
  const vec3 at(place);
  const float wider = widened(margin, place);
  for (int first = 0; first < 8; first += 4) {
    Slots sum{};
    for (int k = 0; k < 3; ++k) {
      const Slots below = slots_at(node.bounds[k][0] + first) - (at[k] + wider),
                  above = (at[k] - wider) - slots_at(node.bounds[k][1] + first);
      const Slots way = greater(Slots{}, greater(below, above));
      sum += way * way;
    }
    std::memcpy(squares + first, &sum, sizeof sum);
  }
}

// The triangles of a block whose boxes lie within the square of a distance, by what their floats tell.
std::uint32_t triangles_within(float square, const layout::u32* rows, std::size_t block, const dvec3& place,
                               double margin) {
  const auto row = [&](std::size_t number, std::size_t first) {
    Slots slots;
    std::memcpy(&slots, rows + number * block + first, sizeof slots);
    return slots;
  };
  const vec3 at(place);
  const float wider = widened(margin, place);
  std::uint32_t bits = 0;
  for (std::size_t first = 0; first < block; first += 4) {
    Slots sum{};
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      const Slots p = row(axis, first), q = row(3 + axis, first), r = row(6 + axis, first);
      const Slots below = lesser(p, lesser(q, r)) - (at[k] + wider),
                  above = (at[k] - wider) - greater(p, greater(q, r));
      const Slots way = greater(Slots{}, greater(below, above));
      sum += way * way;
    }
    const SlotsChosen chosen = sum <= square;
    for (int i = 0; i < 4; ++i)
      bits |= static_cast<std::uint32_t>(chosen[i] & 1) << (first + static_cast<std::size_t>(i));
  }
  return bits;
}

}  // namespace

std::optional<DoubleScene::Nearest> DoubleScene::nearest(const dvec3& place, double most) const {
  struct Entry {
    float square;
    std::uint32_t child;
    bool operator<(const Entry& other) const { return square > other.square; }
  };
  std::optional<Nearest> best;
  double square = most * most;
  if (scene_->wide.nodes.size() == 0) return best;
  // Squares of floats are off by some 4u; the boxes' margin is in them.
  constexpr double kFloats = 1 - 0x1p-20;
  const auto take = [&](double near_square, const Nearest& near) {
    if (!(near_square <= square) || near.distance > most) return;
    if (best && near_square == square && number_of(near.ref) >= number_of(best->ref)) return;
    square = near_square;
    best = near;
  };
  const auto look_at_triangles = [&](std::uint32_t leaf) {
    const auto block = static_cast<std::size_t>(scene_->wide.block);
    visit_blocks(scene_->wide, leaf, [&](const layout::u32* rows, std::size_t n) {
      std::uint32_t lanes = triangles_within(rounded_up(square / kFloats), rows, block, place, margin_);
      for (lanes &= (2u << (n - 1)) - 1; lanes != 0; lanes &= lanes - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
        const std::uint32_t triangle = rows[(KDRAY_TRIANGLE_ROWS - 1) * block + lane] & ~KDRAY_WIDE_LAST;
        ExactLine::Corners corners = doubles_->at(triangle);
        for (dvec3& corner : corners) corner -= place;
        const NearPoint near = near_of(corners);
        take(near.square, {std::sqrt(near.square), near.point + place, ref_of(triangle), near.u, near.v});
      }
      return true;
    });
  };
  const auto look_at_shapes = [&](std::uint32_t leaf) {
    visit_leaf(scene_->wide, leaf, [&](auto kind, std::uint32_t index, const layout::u32*) {
      if constexpr (decltype(kind)::kIsShape) {
        const auto [distance, point] = primitives::nearest_on(decltype(kind)::of(*doubles_)[index], place);
        take(distance * distance, {distance, point, kind.kNumber << KDRAY_REF_KIND_SHIFT | index, 0, 0});
      }
      return false;
    });
  };
  std::vector<Entry> heap{{0, 0}};
  while (!heap.empty()) {
    std::pop_heap(heap.begin(), heap.end());
    const Entry entry = heap.back();
    heap.pop_back();
    if (entry.square * kFloats > square) break;
    if (entry.child & KDRAY_WIDE_LEAF) {
      flatten::leaf_kind(entry.child) == KDRAY_KIND_TRIANGLE ? look_at_triangles(entry.child)
                                                             : look_at_shapes(entry.child);
      continue;
    }
    const WideNode& node = scene_->wide.nodes[entry.child];
    float squares[8];
    squares_to_boxes(node, place, margin_, squares);
    for (std::size_t slot = 0; slot < 8; ++slot) {
      const bool is_there = node.bounds[0][0][slot] <= node.bounds[0][1][slot];
      if (!is_there || squares[slot] * kFloats > square) continue;
      heap.push_back({squares[slot], node.child[slot]});
      std::push_heap(heap.begin(), heap.end());
    }
  }
  return best;
}

}  // namespace kdray::query
