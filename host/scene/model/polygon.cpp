#include "scene/model/polygon.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "scene/model/point_tree.h"
#include "scene/model/predicates.h"

namespace kdray::scene {

namespace {

class NumberSet {
 public:
  explicit NumberSet(std::size_t n) {
    do {
      n = (n + 63) / 64;
      levels_.emplace_back(n, 0);
    } while (n > 1);
  }

  void add(std::size_t i) {
    for (auto& words : levels_) {
      words[i / 64] |= std::uint64_t{1} << (i % 64);
      i /= 64;
    }
  }

  void remove(std::size_t i) {
    for (auto& words : levels_) {
      if (words[i / 64] &= ~(std::uint64_t{1} << (i % 64))) return;
      i /= 64;
    }
  }

  // Returns the first member that is not below i; if there is none, the first of all.
  std::optional<std::uint32_t> next(std::size_t i) const {
    if (const auto found = next_from(i)) return found;
    return next_from(0);
  }

 private:
  std::optional<std::uint32_t> next_from(std::size_t i) const {
    std::size_t level = 0;
    for (; level < levels_.size(); ++level, i = i / 64 + 1) {  // behind the word that had none
      if (i / 64 >= levels_[level].size()) return std::nullopt;
      const std::uint64_t rest = levels_[level][i / 64] >> (i % 64);
      if (rest == 0) continue;
      i += static_cast<std::size_t>(std::countr_zero(rest));
      break;
    }
    if (level == levels_.size()) return std::nullopt;
    while (level > 0) {
      --level;
      i = 64 * i + static_cast<std::size_t>(std::countr_zero(levels_[level][i]));
    }
    return static_cast<std::uint32_t>(i);
  }

  std::vector<std::vector<std::uint64_t>> levels_;
};

using Triple = std::array<std::uint32_t, 3>;

// Returns Newell's normal, which also holds for corners that are not quite in one plane. It is computed about
// the first corner, so that a small polygon far from the origin keeps its digits.
dvec3 newell_normal(std::span<const dvec3> corners) {
  dvec3 normal(0);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    normal += glm::cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  }
  return normal;
}

// Returns the corners in the coordinate plane they are widest in, turning counter-clockwise; exact, for it
// only leaves out a coordinate. Empty when there is no such plane (no area, or not finite).
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

// Returns whether the fan of the first corner covers the polygon once, with no flat triangle: each of its
// triangles turns left, and all corners lie left of the first edge, so that together they open by less than
// half a circle.
bool fan_fits(const std::vector<dvec2>& p) {
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    if (orient_sign(p[0], p[i], p[i + 1]) <= 0 || orient_sign(p[0], p[1], p[i + 1]) <= 0) return false;
  }
  return true;
}

// The triangle of a corner and its neighbours, and what may lie in it.
struct Ear {
  dvec2 a, b, c;

  // Corners at the same place (a bridge to a hole, a repeated corner) are no obstacle to each other.
  bool is_blocked_by(const dvec2& q) const {
    if (q == a || q == b || q == c) return false;
    return orient_sign(a, b, q) >= 0 && orient_sign(b, c, q) >= 0 && orient_sign(c, a, q) >= 0;
  }

  // Returns whether a box surely holds no point that blocks: all of it is on the far side of an edge.
  bool passes_by(const dvec2& lo, const dvec2& hi) const {
    return is_beyond(a, b, lo, hi) || is_beyond(b, c, lo, hi) || is_beyond(c, a, lo, hi);
  }

 private:
  static bool is_beyond(const dvec2& from, const dvec2& to, const dvec2& lo, const dvec2& hi) {
    const dvec2 nearest(to.y > from.y ? lo.x : hi.x,
                        to.x > from.x ? hi.y : lo.y);  // the box's leftmost corner
    return orient_sign(from, to, nearest) < 0;
  }
};

class EarClipper {
 public:
  explicit EarClipper(std::vector<dvec2> points)
      : p_(std::move(points)), open_(p_.size()), obstacles_(p_), left_(size()) {
    prev_.resize(size());
    next_.resize(size());
    for (std::uint32_t i = 0; i < size(); ++i) {
      prev_[i] = (i + size() - 1) % size();
      next_[i] = (i + 1) % size();
    }
    turn_.resize(size());
    for (std::uint32_t i = 0; i < size(); ++i) look_at(i);
  }

  std::vector<Triple> run() {
    triangles_.reserve(size() - 2);
    std::uint32_t at = 0;  // where to look for the next ear
    bool refreshed = false;
    while (left_ > 3 && work_ < most_work()) {
      const std::optional<std::uint32_t> corner = open_.next(at);
      if (corner && !is_ear(*corner)) {
        open_.remove(*corner);
      } else if (!corner && !refreshed) {
        // In a simple polygon a corner that is no ear becomes one only when a neighbour goes. This polygon
        // isn't simple, so look again.
        for (std::uint32_t i = 0, b = at; i < left_; ++i, b = next_[b]) look_at(b);
        work_ += left_;
        refreshed = true;
      } else {
        at = clip(corner ? *corner : least_bad(at));
        refreshed = false;
      }
    }
    fan_of_rest(at);
    return std::move(triangles_);
  }

  // Returns whether the polygon was cut to the end, without a fan for the rest.
  bool finished() const { return work_ < most_work(); }

 private:
  // Tests of a point against a triangle after which the rest becomes a fan: some seconds of them. Simple
  // polygons take up to 150 a corner; only one of many thousand corners that also crosses itself gets here.
  std::uint64_t most_work() const { return 50'000'000 + std::uint64_t{500} * size(); }

  std::uint32_t size() const { return static_cast<std::uint32_t>(p_.size()); }

  // Only corners that don't turn left can be the nearest obstacle inside an ear (Meisters), and only the
  // others can be ears.
  void look_at(std::uint32_t b) {
    turn_[b] = orient_sign(p_[prev_[b]], p_[b], p_[next_[b]]);
    obstacles_.set(b, turn_[b] <= 0);
    turn_[b] > 0 ? open_.add(b) : open_.remove(b);
  }

  bool is_ear(std::uint32_t corner) {
    const Ear ear{p_[prev_[corner]], p_[corner], p_[next_[corner]]};
    const dvec2 lo = glm::min(glm::min(ear.a, ear.b), ear.c), hi = glm::max(glm::max(ear.a, ear.b), ear.c);
    return !obstacles_.any_within(
        lo, hi,
        [&](std::uint32_t i) {
          ++work_;
          return ear.is_blocked_by(p_[i]);
        },
        [&](const dvec2& box_lo, const dvec2& box_hi) { return ear.passes_by(box_lo, box_hi); });
  }

  // Cuts off corner b and returns where to look next: not the neighbour, for that would make a fan of
  // slivers.
  std::uint32_t clip(std::uint32_t b) {
    const std::uint32_t a = prev_[b];
    const std::uint32_t c = next_[b];
    triangles_.push_back({a, b, c});
    next_[a] = c;
    prev_[c] = a;
    --left_;
    obstacles_.set(b, false);
    open_.remove(b);
    look_at(a);
    look_at(c);
    return next_[c];
  }

  // Returns what to cut off in a polygon without an ear (it touches or crosses itself): a corner without
  // area, or else one that turns left.
  std::uint32_t least_bad(std::uint32_t at) {
    std::uint32_t best = at;
    for (std::uint32_t i = 0, b = at; i < left_; ++i, b = next_[b]) {
      ++work_;
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
  NumberSet open_;  // of corners that turn left, those not known to be no ear
  PointTree obstacles_;
  std::uint32_t left_;
  std::uint64_t work_ = 0;
  std::vector<Triple> triangles_;
};

}  // namespace

std::vector<Triple> triangulate(std::span<const dvec3> corners, bool* finished) {
  if (finished) *finished = true;
  const auto n = static_cast<std::uint32_t>(corners.size());
  if (n < 3) return {};
  const auto bad = std::ranges::find_if(corners, [](const dvec3& c) { return !is_finite(c); });
  if (bad != corners.end()) {
    const auto corner = static_cast<std::uint32_t>(bad - corners.begin());
    return std::vector<Triple>(n - 2, {corner, corner, corner});
  }
  if (n == 3) return {{0, 1, 2}};
  std::vector<dvec2> flat = project(corners);
  if (flat.empty() || fan_fits(flat)) return fan(n);
  EarClipper clipper(std::move(flat));
  std::vector<Triple> triangles = clipper.run();
  if (finished) *finished = clipper.finished();
  return triangles;
}

namespace {

void add_texcoords(Scene& scene, std::span<const std::array<float, 2>> texcoords,
                   const std::array<std::uint32_t, 3>& pick) {
  layout::TexCoords at{};
  for (std::size_t i = 0; i < 3; ++i)
    at.uv[i][0] = texcoords[pick[i]][0], at.uv[i][1] = texcoords[pick[i]][1];
  auto& all = scene.texturing.texcoords[0];
  all.resize(scene.triangles.size() - 1);  // those of earlier triangles that had none
  all.push_back(at);
}

void add_triangle(Scene& scene, std::span<const std::uint32_t> corners,
                  std::span<const std::uint32_t> normals, const std::array<std::uint32_t, 3>& pick,
                  std::uint32_t material, std::span<const std::array<float, 2>> texcoords) {
  Triangle t{.vertex = {corners[pick[0]], corners[pick[1]], corners[pick[2]]}};
  if (!normals.empty()) t.normal = {normals[pick[0]], normals[pick[1]], normals[pick[2]]};
  t.material = material;
  t.number = static_cast<std::uint32_t>(scene.triangles.size());
  scene.triangles.push_back(t);
  if (!texcoords.empty()) add_texcoords(scene, texcoords, pick);
}

}  // namespace

std::string polygon_warning(std::size_t n_corners) {
  return "a polygon of " + std::to_string(n_corners) +
         " corners crosses itself too often to be cut up: part of it is a fan";
}

bool add_polygon(Scene& scene, std::span<const std::uint32_t> corners, std::span<const std::uint32_t> normals,
                 std::uint32_t material, std::span<const std::array<float, 2>> texcoords) {
  if (corners.size() < 3) return true;
  if (corners.size() == 3) {
    add_triangle(scene, corners, normals, {0, 1, 2}, material, texcoords);
    return true;
  }
  std::vector<dvec3> points;
  points.reserve(corners.size());
  for (const std::uint32_t c : corners) points.push_back(scene.vertices[c]);
  bool finished = true;
  for (const auto& pick : triangulate(points, &finished))
    add_triangle(scene, corners, normals, pick, material, texcoords);
  return finished;
}

}  // namespace kdray::scene
