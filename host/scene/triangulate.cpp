#include "scene/triangulate.h"

#include <algorithm>
#include <utility>

#include "scene/predicates.h"

namespace kdray::scene {

namespace {

using Triple = std::array<std::uint32_t, 3>;

// Newell's normal, which also holds for corners that are not quite in one plane. About the first corner, so
// that a small polygon far from the origin keeps its digits.
dvec3 newell_normal(std::span<const dvec3> corners) {
  dvec3 normal(0);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    normal += glm::cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  }
  return normal;
}

// The corners in the coordinate plane they are widest in, turning counter-clockwise; exact, for it only
// leaves out a coordinate. Empty when there is no such plane (no area, or not finite).
std::vector<dvec2> project(std::span<const dvec3> corners) {
  const dvec3 normal = newell_normal(corners);
  const dvec3 size = glm::abs(normal);
  if (!is_finite(normal) || !(size.x + size.y + size.z > 0)) return {};
  int axis = size.x > size.y ? 0 : 1;
  if (size.z > size[axis]) axis = 2;
  int u = (axis + 1) % 3;
  int v = (axis + 2) % 3;
  if (normal[axis] < 0) std::swap(u, v);
  std::vector<dvec2> flat(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) flat[i] = {corners[i][u], corners[i][v]};
  return flat;
}

std::vector<Triple> fan(std::uint32_t n) {
  std::vector<Triple> triangles(n - 2);
  for (std::uint32_t i = 0; i + 2 < n; ++i) triangles[i] = {0, i + 1, i + 2};
  return triangles;
}

// Whether the fan of the first corner covers the polygon once, with no flat triangle: each of its triangles
// turns left, and all corners lie left of the first edge, so that together they open by less than half a
// circle.
bool fan_fits(const std::vector<dvec2>& p) {
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    if (orient_sign(p[0], p[i], p[i + 1]) <= 0 || orient_sign(p[0], p[1], p[i + 1]) <= 0) return false;
  }
  return true;
}

class EarClipper {
 public:
  explicit EarClipper(std::vector<dvec2> points) : p_(std::move(points)), left_(size()) {
    prev_.resize(size());
    next_.resize(size());
    for (std::uint32_t i = 0; i < size(); ++i) {
      prev_[i] = (i + size() - 1) % size();
      next_[i] = (i + 1) % size();
    }
    turn_.resize(size());
    rejected_.assign(size(), false);
    for (std::uint32_t i = 0; i < size(); ++i) turn_[i] = turn_at(i);
    sort_blockers();
  }

  std::vector<Triple> run() {
    triangles_.reserve(size() - 2);
    std::uint32_t at = 0;
    std::uint32_t visited = 0;  // corners since the last clip
    bool refreshed = false;
    while (left_ > 3 && work_ < kMostWork) {
      if (is_ear(at)) {
        at = clip(at);
        visited = 0;
        refreshed = false;
      } else if (++visited <= left_) {
        rejected_[at] = true;
        at = next_[at];
      } else if (!refreshed) {
        // A rejected corner stays rejected until a neighbour goes, in a simple polygon. This one isn't, so
        // look again.
        std::fill(rejected_.begin(), rejected_.end(), false);
        visited = 0;
        refreshed = true;
      } else {
        at = clip(least_bad(at));
        visited = 0;
        refreshed = false;
      }
    }
    fan_of_rest(at);
    return std::move(triangles_);
  }

 private:
  // Tests of a point against a triangle after which the rest becomes a fan. Only a polygon of many thousand
  // corners that also crosses itself gets here; it must not hang.
  static constexpr std::uint64_t kMostWork = 200'000'000;

  std::uint32_t size() const { return static_cast<std::uint32_t>(p_.size()); }
  int turn_at(std::uint32_t b) const { return orient_sign(p_[prev_[b]], p_[b], p_[next_[b]]); }

  // Only corners that don't turn left can be the nearest obstacle inside an ear (Meisters). They are kept
  // sorted by x, so that a small ear looks at few of them.
  void sort_blockers() {
    blockers_.clear();
    for (std::uint32_t i = 0; i < size(); ++i) {
      if (turn_[i] <= 0) blockers_.push_back(i);
    }
    std::ranges::sort(blockers_, [&](std::uint32_t a, std::uint32_t b) { return p_[a].x < p_[b].x; });
    live_blockers_ = blockers_.size();
  }

  void set_turn(std::uint32_t b, int turn) {
    if (turn_[b] <= 0 && turn > 0) {
      --live_blockers_;
    } else if (turn_[b] > 0 && turn <= 0) {
      // Clipping can make a corner flat or reflex only where the polygon isn't simple.
      const auto place =
          std::ranges::lower_bound(blockers_, p_[b].x, {}, [&](std::uint32_t i) { return p_[i].x; });
      if (std::ranges::find(blockers_, b) == blockers_.end()) blockers_.insert(place, b);
      ++live_blockers_;
    }
    turn_[b] = turn;
    if (2 * live_blockers_ < blockers_.size()) {
      std::erase_if(blockers_, [&](std::uint32_t i) { return turn_[i] > 0; });
    }
  }

  bool is_ear(std::uint32_t b) {
    if (rejected_[b] || turn_[b] <= 0) return false;
    const dvec2& a = p_[prev_[b]];
    const dvec2& c = p_[next_[b]];
    const dvec2 lo = glm::min(glm::min(a, p_[b]), c);
    const dvec2 hi = glm::max(glm::max(a, p_[b]), c);
    auto it = std::ranges::lower_bound(blockers_, lo.x, {}, [&](std::uint32_t i) { return p_[i].x; });
    for (; it != blockers_.end() && p_[*it].x <= hi.x; ++it) {
      ++work_;
      const dvec2& q = p_[*it];
      if (q.y < lo.y || q.y > hi.y || turn_[*it] > 0) continue;
      // Corners at the same place (a bridge to a hole, a repeated corner) are no obstacle to each other.
      if (q == a || q == p_[b] || q == c) continue;
      if (orient_sign(a, p_[b], q) >= 0 && orient_sign(p_[b], c, q) >= 0 && orient_sign(c, a, q) >= 0)
        return false;
    }
    return true;
  }

  // Takes corner b off and returns where to look next: not the neighbour, for that would make a fan of
  // slivers.
  std::uint32_t clip(std::uint32_t b) {
    const std::uint32_t a = prev_[b];
    const std::uint32_t c = next_[b];
    triangles_.push_back({a, b, c});
    next_[a] = c;
    prev_[c] = a;
    --left_;
    set_turn(b, 1);  // gone: no obstacle any more
    set_turn(a, turn_at(a));
    set_turn(c, turn_at(c));
    rejected_[a] = rejected_[c] = false;
    return next_[c];
  }

  // The corner to cut in a polygon without an ear, which touches or crosses itself: one without area, else
  // one that turns left.
  std::uint32_t least_bad(std::uint32_t at) const {
    std::uint32_t best = at;
    for (std::uint32_t i = 0, b = at; i < left_; ++i, b = next_[b]) {
      if (turn_[b] == 0) return b;
      if (turn_[b] > turn_[best]) best = b;
    }
    return best;
  }

  void fan_of_rest(std::uint32_t at) {
    for (std::uint32_t b = next_[at]; left_ >= 3; --left_, b = next_[b])
      triangles_.push_back({at, b, next_[b]});
  }

  std::vector<dvec2> p_;
  std::vector<std::uint32_t> prev_, next_;
  std::vector<int> turn_;
  std::vector<bool> rejected_;  // known to be no ear as long as its neighbours stay
  std::vector<std::uint32_t> blockers_;
  std::size_t live_blockers_ = 0;
  std::uint32_t left_;
  std::uint64_t work_ = 0;
  std::vector<Triple> triangles_;
};

}  // namespace

std::vector<Triple> triangulate(std::span<const dvec3> corners) {
  const auto n = static_cast<std::uint32_t>(corners.size());
  if (n < 3) return {};
  if (n == 3) return {{0, 1, 2}};
  std::vector<dvec2> flat = project(corners);
  if (flat.empty() || fan_fits(flat)) return fan(n);
  return EarClipper(std::move(flat)).run();
}

}  // namespace kdray::scene
