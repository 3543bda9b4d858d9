#include "engine/query/double_scene.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "engine/query/double_walk.h"
#include "engine/query/scene_arguments.h"
#include "engine/query/surface.h"
#include "engine/query/wide_boxes.h"
#include "scene/primitives/shapes.h"

namespace kdray::query {

namespace {

using layout::WideNode;

constexpr double kBoxes = 0x1p-18;  // 64u of the reach: see double_scene.h

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

}  // namespace

DoubleScene::DoubleScene(const prepare::Prepared& scene, const GeometryTable* table)
    : scene_(&scene),
      doubles_(scene.doubles.get()),
      table_(table),
      reach_(world_max(scene.geometry.bounds)),
      margin_(kBoxes * reach_ + scene.doubles->apart),
      has_every_bit_(table == nullptr || table->has_every_bit()) {}

// A primitive that may be hit: t lies between these. Of a shape that is t as it is told, `rest` what is left,
// and it may be hit at several: `nth`.
struct DoubleScene::Candidate {
  std::uint32_t ref;
  ExactLine::Bounds t;
  std::uint32_t nth = 0;
  double u = 0, rest = 0;

  auto key() const { return std::pair(ref, nth); }
};

// A ray, and how far it goes on.
class DoubleScene::Line : public ExactLine {
 public:
  Line(const DoubleScene& scene, const Question& question)
      : ExactLine(exact(question.ray.line)), scene_(&scene), ray_(&question.ray), end_(question.ray.t_max) {}

  LineInFloats in_floats() const {
    const dvec3 start = ray_->place_at_start();
    LineInFloats line(start, ray_->line.direction, widened(scene_->margin_, start), scene_->reach_);
    line.begin = rounded_down(ray_->t_min - ray_->start - slack(ray_->t_min));
    line.end = end_in_floats();
    return line;
  }
  float end_in_floats() const { return rounded_up(end_ - ray_->start + slack(end_)); }
  void end_at(double t) { end_ = std::min(t, end_); }

  // Calls visit(candidate) for each hit of a primitive with t between t_min and where the line ends, until
  // one answers false; whether none did. from_start: at 0, where t_min is 0, as well.
  template <class Visit>
  bool visit_hits(std::uint32_t ref, bool from_start, const Visit& visit) {
    if (is_triangle(ref)) {
      Candidate candidate{ref, {}};
      return !hits(candidate, from_start) || visit(candidate);
    }
    if (was_asked(ref)) return true;
    std::uint32_t nth = 0;
    for (const auto& [t, u, rest] : crossings_of_shape(ref)) {
      const Candidate candidate{ref, {t, t}, nth++, u, rest};
      if (t <= end_ && is_between(t, from_start) && !visit(candidate)) return false;
    }
    return true;
  }

  // By t: of triangles exactly, of others as pairs have it; then triangles first, and by number. False for
  // the same hit.
  bool precedes(const Candidate& a, const Candidate& b) const {
    if (a.key() == b.key()) return false;
    if (a.t.most < b.t.least) return true;
    if (b.t.most < a.t.least) return false;
    return is_triangle(a.ref) && is_triangle(b.ref) ? is_before(a, b) : place_of(a) < place_of(b);
  }

  // In that order. (Beside shapes that of triangles begins with pairs too, so that it is one.)
  void sort(std::vector<Candidate>& candidates) const {
    const auto is_of_shape = [](const Candidate& c) { return !is_triangle(c.ref); };
    if (std::ranges::none_of(candidates, is_of_shape)) {
      std::sort(candidates.begin(), candidates.end(),
                [&](const Candidate& a, const Candidate& b) { return precedes(a, b); });
      return;
    }
    struct Placed {
      Place place;
      Candidate candidate;
    };
    std::vector<Placed> placed;
    for (const Candidate& candidate : candidates) placed.push_back({place_of(candidate), candidate});
    std::sort(placed.begin(), placed.end(), [&](const Placed& a, const Placed& b) {
      return a.place != b.place ? a.place < b.place
                                : is_triangle(a.candidate.ref) && is_before(a.candidate, b.candidate);
    });
    for (std::size_t i = 0; i < placed.size(); ++i) candidates[i] = placed[i].candidate;
  }

 private:
  // Between t here and in floats from the start on.
  double slack(double t) const {
    return 0x1p-48 * (std::abs(ray_->start) + (std::isinf(t) ? 0 : std::abs(t)));
  }

  // Where a hit comes beside shapes: t, with so much of what a double leaves that what lies in one place is
  // there for pairs as well; whether it is a shape's; of shapes the number and which of its hits it is.
  using Place = std::tuple<double, double, bool, std::uint32_t, std::uint32_t>;
  Place place_of(const Candidate& c) const {
    const Pair t = is_triangle(c.ref) ? t_in_pair(corners_of(c)) : Pair(c.t.least, c.rest);
    const double step = 0x1p-96 * std::abs(t.high), rest = step > 0 ? std::nearbyint(t.low / step) : 0;
    if (is_triangle(c.ref)) return {t.high, rest, false, 0, 0};
    return {t.high, rest, true, scene_->number_of(c.ref), c.nth};
  }

  // Of triangles, exactly.
  bool is_before(Candidate a, Candidate b) const {
    settle(a), settle(b);
    if (a.t.most < b.t.least) return true;
    if (b.t.most < a.t.least) return false;
    const int order = compare_t(corners_of(a), corners_of(b));
    return order != 0 ? order < 0 : scene_->number_of(a.ref) < scene_->number_of(b.ref);
  }

  Corners corners_of(const Candidate& triangle) const {
    return scene_->doubles_->at(triangle.ref & KDRAY_REF_INDEX_MASK);
  }

  bool is_between(double t, bool from_start) const {
    return (t > ray_->t_min || (from_start && t == 0 && ray_->t_min == 0)) && t < ray_->t_max;
  }

  // Whether the line crosses a triangle; bounds its t.
  bool hits(Candidate& candidate, bool from_start) const {
    const Corners corners = corners_of(candidate);
    candidate.t = bounds_of_t(corners);
    if (candidate.t.most < ray_->t_min || candidate.t.least > end_ || !crosses(corners)) return false;
    if (candidate.t.least > ray_->t_min && candidate.t.most < ray_->t_max) return true;
    return is_between(settle(candidate), from_start);
  }

  primitives::Crossings crossings_of_shape(std::uint32_t ref) const {
    const DoubleLine& line = ray_->line;
    return primitives::with_kind(ref >> KDRAY_REF_KIND_SHIFT, [&](auto kind) -> primitives::Crossings {
      if constexpr (decltype(kind)::kIsShape)
        return primitives::crossings({line.origin, line.direction, line.rest, ray_->t_min, end_},
                                     decltype(kind)::of(*scene_->doubles_)[ref & KDRAY_REF_INDEX_MASK]);
      return {};
    });
  }

  // Whether a shape is one of the last ones: it lies in several leaves, and its crossings take long to find.
  bool was_asked(std::uint32_t ref) {
    if (std::ranges::find(asked_, ref) != asked_.end()) return true;
    asked_[next_asked_++ % asked_.size()] = ref;
    return false;
  }

  // Returns a triangle's t.
  double settle(Candidate& candidate) const {
    const double t = t_of(corners_of(candidate));
    candidate.t = around(t);
    return t;
  }

  const DoubleScene* scene_;
  const DoubleRay* ray_;
  double end_;
  std::array<std::uint32_t, 8> asked_{};  // 0 is a triangle's reference
  std::size_t next_asked_ = 0;
};

// What line i hits is found(i, line, candidate), once for each leaf that it lies in: whether it goes on.
template <class Found>
class DoubleScene::RayDecider final : public Decider {
 public:
  RayDecider(const DoubleScene& scene, std::span<const Question> questions, std::span<Line> lines,
             bool from_start, const Found& found)
      : scene_(scene), questions_(questions), lines_(lines), from_start_(from_start), found_(found) {}

  float decide(std::size_t i, std::uint32_t ref) override {
    const auto take = [&](const Candidate& candidate) { return found_(i, lines_[i], candidate); };
    if (scene_.is_seen(ref, questions_[i].mask) && !lines_[i].visit_hits(ref, from_start_, take))
      return -HUGE_VALF;
    return lines_[i].end_in_floats();
  }

 private:
  const DoubleScene& scene_;
  const std::span<const Question> questions_;
  const std::span<Line> lines_;
  const bool from_start_;
  const Found& found_;
};

template <class Found>
std::vector<DoubleScene::Line> DoubleScene::walk(std::span<const Question> questions, bool from_start,
                                                 const Found& found) const {
  std::vector<Line> lines;
  std::vector<LineInFloats> in_floats;
  lines.reserve(questions.size());
  in_floats.reserve(questions.size());
  for (const Question& question : questions)
    in_floats.push_back(lines.emplace_back(*this, question).in_floats());
  RayDecider decider(*this, questions, lines, from_start, found);
  walk_primitives(scene_->wide, *doubles_, in_floats, decider);
  return lines;
}

std::uint32_t DoubleScene::number_of(std::uint32_t ref) const {
  return query::number_of(scene_->flat, ref);
}

bool DoubleScene::is_seen(std::uint32_t ref, std::uint32_t mask) const {
  return has_every_bit_ ? mask != 0 : (table_->mask_of(number_of(ref)) & mask) != 0;
}

template <class QuestionOf, class CandidateOf, class Told>
void DoubleScene::tell_candidates(std::size_t n, const QuestionOf& question, const CandidateOf& candidate,
                                  const Told& told) const {
  std::vector<std::size_t> triangles;
  triangles.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Candidate& c = candidate(i);
    if (is_triangle(c.ref))
      triangles.push_back(i);
    else
      told(i, ExactHit{question(i).ray.line.caller_t(c.t.least), c.u, 0, c.ref, kNoInstance});
  }
  tell(
      triangles.size(), [&](std::size_t k) { return question(triangles[k]).ray.line; },
      [&](std::size_t k) { return candidate(triangles[k]).ref & KDRAY_REF_INDEX_MASK; },
      [&](std::size_t k, const ExactHit& hit) { told(triangles[k], hit); });
}

void DoubleScene::closest(std::span<const Question> questions,
                          std::span<std::optional<ExactHit>> hits) const {
  std::vector<std::optional<Candidate>> best(questions.size());
  const std::vector<Line> lines =
      walk(questions, false, [&](std::size_t i, Line& line, const Candidate& candidate) {
        if (best[i] && !line.precedes(candidate, *best[i])) return true;
        best[i] = candidate;
        line.end_at(candidate.t.most);
        return true;
      });
  std::vector<std::size_t> hit;
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (best[i]) hit.push_back(i);
  tell_candidates(
      hit.size(), [&](std::size_t k) -> const Question& { return questions[hit[k]]; },
      [&](std::size_t k) -> const Candidate& { return *best[hit[k]]; },
      [&](std::size_t k, const ExactHit& told) { hits[questions[hit[k]].place] = told; });
}

void DoubleScene::any(std::span<const Question> questions, std::span<std::uint8_t> hit) const {
  walk(questions, false, [&](std::size_t i, const Line&, const Candidate&) {
    hit[questions[i].place] = 1;
    return false;
  });
}

// Calls collected(i, line, candidates) for the lines that hit any, each hit once.
template <class Collected>
void DoubleScene::collect(std::span<const Question> questions, const Collected& collected) const {
  struct Of {
    std::size_t line;
    Candidate candidate;
    auto key() const { return std::pair(line, candidate.key()); }
  };
  std::vector<Of> found;
  const std::vector<Line> lines =
      walk(questions, true, [&](std::size_t i, const Line&, const Candidate& candidate) {
        found.push_back({i, candidate});
        return true;
      });
  std::sort(found.begin(), found.end(), [](const Of& a, const Of& b) { return a.key() < b.key(); });
  std::vector<Candidate> of_line;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const std::size_t i = found[k].line;
    if (k == 0 || found[k - 1].key() != found[k].key()) of_line.push_back(found[k].candidate);
    if (k + 1 < found.size() && found[k + 1].line == i) continue;
    collected(i, lines[i], of_line);
    of_line.clear();
  }
}

void DoubleScene::count(std::span<const Question> questions, std::span<std::uint32_t> counts) const {
  collect(questions, [&](std::size_t i, const Line&, const std::vector<Candidate>& candidates) {
    counts[questions[i].place] = static_cast<std::uint32_t>(candidates.size());
  });
}

void DoubleScene::all(std::span<const Question> questions, std::span<std::vector<ExactHit>> hits) const {
  collect(questions, [&](std::size_t i, const Line& line, std::vector<Candidate>& candidates) {
    line.sort(candidates);
    std::vector<ExactHit>& told = hits[questions[i].place];
    told.resize(candidates.size());
    tell_candidates(
        told.size(), [&](std::size_t) -> const Question& { return questions[i]; },
        [&](std::size_t k) -> const Candidate& { return candidates[k]; },
        [&](std::size_t k, const ExactHit& hit) { told[k] = hit; });
  });
}

namespace {

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
