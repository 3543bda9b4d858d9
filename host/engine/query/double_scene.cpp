#include "engine/query/double_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "engine/query/double_walk.h"
#include "engine/query/scene_arguments.h"
#include "engine/query/surface.h"
#include "engine/query/wide_boxes.h"
#include "scene/primitives/shapes.h"

namespace kdray::query {

namespace {

constexpr double kBoxes = 0x1p-18;  // 64u of the reach: see double_scene.h

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

}  // namespace kdray::query
