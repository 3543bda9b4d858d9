#include "scene/model/zero_area.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <functional>
#include <memory>
#include <span>
#include <tuple>
#include <utility>

#include "scene/model/predicates.h"

namespace kdray::scene {

namespace zero_area_edges {

// A corner by its coordinates' bits, -0 as 0.
using Place = std::array<std::uint32_t, 3>;

inline Place place_of(const layout::Triangle& t, std::size_t corner) {
  Place place;
  for (std::size_t k = 0; k < 3; ++k) place[k] = std::bit_cast<std::uint32_t>(t.v[corner][k] + 0.0f);
  return place;
}

// The k-th edge of a triangle, whichever way it runs.
struct Edge {
  Place from, to;

  Edge(const layout::Triangle& t, std::size_t k) : from(place_of(t, k)), to(place_of(t, (k + 1) % 3)) {
    if (to < from) std::swap(from, to);
  }
  auto operator<=>(const Edge&) const = default;
};

}  // namespace zero_area_edges

namespace {

using zero_area_edges::Edge, zero_area_edges::Place, zero_area_edges::place_of;

constexpr std::size_t kSideGrain = std::size_t{1} << 14;

double length2_of_edge(const layout::Triangle& t, std::size_t k) {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double along = static_cast<double>(t.v[(k + 1) % 3][i]) - t.v[k][i];
    sum += along * along;
  }
  return sum;
}

void lower_to(std::uint32_t& shared, std::uint32_t to) {
  const std::atomic_ref value(shared);
  std::uint32_t old = value.load();
  while (to < old && !value.compare_exchange_weak(old, to)) {
  }
}

}  // namespace

vec3 ZeroAreaSides::normal_of(const layout::Triangle& t) {
  const dvec3 a(t.v[0][0], t.v[0][1], t.v[0][2]), b(t.v[1][0], t.v[1][1], t.v[1][2]),
      c(t.v[2][0], t.v[2][1], t.v[2][2]);
  const dvec3 n = glm::cross(b - a, c - a);
  const double length = glm::length(n);
  return length > 0 ? vec3(n / length) : vec3(0);
}

// An edge of a zero-area triangle.
struct ZeroAreaSides::Side {
  zero_area_edges::Edge edge;
  std::uint32_t triangle;  // its number
  double length2;
};

// Distinguishes most corners that no zero-area triangle has from those that one may have.
class ZeroAreaSides::Filter {
 public:
  void add(const Place& place) { bits_[hash(place) / 64] |= std::uint64_t{1} << hash(place) % 64; }
  bool may_have(const Place& place) const { return (bits_[hash(place) / 64] >> hash(place) % 64 & 1) != 0; }

 private:
  static constexpr std::size_t kBits = std::size_t{1} << 20;

  static std::size_t hash(const Place& place) {
    std::uint64_t h = 0;
    for (const std::uint32_t word : place) h = (h ^ word) * 0x9e3779b97f4a7c15u;
    return h >> 44;
  }
  std::vector<std::uint64_t> bits_ = std::vector<std::uint64_t>(kBits / 64);
};

struct ZeroAreaSides::ByEdge {
  bool operator()(const Side& a, const Edge& b) const { return a.edge < b; }
  bool operator()(const Edge& a, const Side& b) const { return a < b.edge; }
};

ZeroAreaSides::ZeroAreaSides(std::span<const layout::Triangle> zero_area)
    : n_zero_area_(zero_area.size()), filter_(std::make_unique<Filter>()) {
  for (std::uint32_t s = 0; s < zero_area.size(); ++s)
    for (std::size_t k = 0; k < 3; ++k) {
      sides_.push_back({Edge(zero_area[s], k), s, length2_of_edge(zero_area[s], k)});
      filter_->add(place_of(zero_area[s], k));
    }
  tbb::parallel_sort(sides_, [](const Side& a, const Side& b) {
    return std::tie(a.edge, a.triangle) < std::tie(b.edge, b.triangle);
  });
  neighbours_.assign(sides_.size(), kNobody);
}
ZeroAreaSides::~ZeroAreaSides() = default;

// Has every triangle with area meet every edge of one without. Of several at an edge the first counts,
// whichever thread comes first.
void ZeroAreaSides::meet(const layout::Triangle& t, std::uint32_t place) {
  if (is_zero_area(t)) return;
  const bool shared[3] = {filter_->may_have(place_of(t, 0)), filter_->may_have(place_of(t, 1)),
                          filter_->may_have(place_of(t, 2))};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!shared[k] || !shared[(k + 1) % 3]) continue;
    const auto [first, last] = std::equal_range(sides_.begin(), sides_.end(), Edge(t, k), ByEdge());
    for (auto side = first; side != last; ++side)
      lower_to(neighbours_[static_cast<std::size_t>(side - sides_.begin())], place);
  }
}

std::vector<vec3> ZeroAreaSides::normals(const std::function<vec3(std::size_t)>& normal_of_neighbour) const {
  std::vector<vec3> normals(n_zero_area_, vec3(0));
  // Prefers the neighbour at the longest edge: the face that was not divided there.
  std::vector<double> longest(n_zero_area_, -1);
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const Side& side = sides_[i];
    if (neighbours_[i] == kNobody || !(side.length2 > longest[side.triangle])) continue;
    const vec3 normal = normal_of_neighbour(i);
    if (normal == vec3(0)) continue;
    longest[side.triangle] = side.length2;
    normals[side.triangle] = normal;
  }
  // Passes normals from one to the next over common edges, a round for each step.
  std::vector<std::vector<std::uint32_t>> beside(n_zero_area_);
  for (std::size_t first = 0, last; first < sides_.size(); first = last) {
    for (last = first + 1; last < sides_.size() && sides_[last].edge == sides_[first].edge; ++last) {
      beside[sides_[first].triangle].push_back(sides_[last].triangle);
      beside[sides_[last].triangle].push_back(sides_[first].triangle);
    }
  }
  std::vector<std::uint32_t> known;
  for (std::uint32_t s = 0; s < normals.size(); ++s)
    if (normals[s] != vec3(0)) known.push_back(s);
  for (std::size_t next = 0; next < known.size(); ++next)
    for (const std::uint32_t s : beside[known[next]]) {
      if (normals[s] != vec3(0)) continue;
      normals[s] = normals[known[next]];
      known.push_back(s);
    }
  return normals;
}

bool is_flat(const layout::Triangle& t) {
  const auto is_seen_across = [&](std::size_t i, std::size_t k, const auto& sign) {
    const auto place = [&](const float(&v)[3]) { return dvec2(v[i], v[k]); };
    return sign(place(t.v[0]), place(t.v[1]), place(t.v[2])) != 0;
  };
  const auto is_seen = [&](const auto& sign) {
    return is_seen_across(0, 1, sign) || is_seen_across(1, 2, sign) || is_seen_across(2, 0, sign);
  };
  // Asks for exact signs only where no projection is sure: a wall vanishes in two of the three.
  return !is_seen(sure_orient_sign) && !is_seen(orient_sign);
}

std::vector<ZeroAreaTriangle> find_zero_area(const Array<layout::Triangle>& triangles) {
  std::vector<ZeroAreaTriangle> zero_area;
  std::vector<layout::Triangle> marked;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    if (!is_zero_area(triangles[i])) continue;
    zero_area.push_back({i, vec3(0)});
    marked.push_back(triangles[i]);
  }
  ZeroAreaSides sides(marked);
  tbb::parallel_for(std::size_t{0}, (triangles.size() + kSideGrain - 1) / kSideGrain, [&](std::size_t grain) {
    const std::size_t first = grain * kSideGrain, last = std::min(triangles.size(), first + kSideGrain);
    for (std::size_t i = first; i < last; ++i) sides.meet(triangles[i], static_cast<std::uint32_t>(i));
  });
  const std::vector<vec3> normals = sides.normals(
      [&](std::size_t side) { return ZeroAreaSides::normal_of(triangles[sides.neighbours()[side]]); });
  for (std::size_t i = 0; i < zero_area.size(); ++i) zero_area[i].normal = normals[i];
  return zero_area;
}

}  // namespace kdray::scene
