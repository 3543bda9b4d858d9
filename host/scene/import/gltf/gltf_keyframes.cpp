#include "scene/import/gltf/gltf_keyframes.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "scene/import/gltf/gltf_accessor.h"

namespace kdray::scene::gltf {

namespace {

enum class Way { linear, step, cubic };

Way way_of(const JsonNode& sampler) {
  const auto node = sampler.find("interpolation");
  if (!node || node->string() == "LINEAR") return Way::linear;
  if (node->string() == "STEP") return Way::step;
  if (node->string() == "CUBICSPLINE") return Way::cubic;
  throw node->expected("LINEAR, STEP or CUBICSPLINE");
}

// Where among the keyframes a time is: a share of the way from one to the next.
struct Place {
  std::size_t from = 0, to = 0;
  double share = 0;
  double seconds = 0;  // between the two
};

Place place_of(const RawVector<double>& times, double time) {
  const auto next = static_cast<std::size_t>(std::ranges::upper_bound(times, time) - times.begin());
  if (next == 0) return {};
  if (next == times.size()) return {next - 1, next - 1};
  const double seconds = times[next] - times[next - 1];
  if (!(seconds > 0)) return {next - 1, next - 1};  // times that don't increase
  return {next - 1, next, std::clamp((time - times[next - 1]) / seconds, 0.0, 1.0), seconds};
}

// The weights of a cubic's two values and two slopes.
struct Hermite {
  double from, from_slope, to, to_slope;

  explicit Hermite(const Place& p) {
    const double t = p.share, t2 = t * t, t3 = t2 * t;
    from = 2 * t3 - 3 * t2 + 1;
    from_slope = p.seconds * (t3 - 2 * t2 + t);
    to = -2 * t3 + 3 * t2;
    to_slope = p.seconds * (t3 - t2);
  }
};

class Sampler {
 public:
  Sampler(Document& document, const JsonNode& sampler, double time)
      : node_(sampler), output_(document.entry("accessors", sampler["output"])), way_(way_of(sampler)) {
    const JsonNode& input = document.entry("accessors", sampler["input"]);
    const auto times = read_scalars(document, input);
    if (times.empty()) throw input.error("an animation without keyframes");
    n_ = times.size();
    place_ = place_of(times, time);
  }

  const JsonNode& output() const { return output_; }
  Way way() const { return way_; }
  double share() const { return way_ == Way::step ? 0 : place_.share; }

  // A keyframe has `n` elements for each of its values.
  void expect(std::size_t there, std::size_t n) const {
    const std::size_t wanted = n_ * n * (way_ == Way::cubic ? 3 : 1);
    if (there == wanted) return;
    throw node_.error("its " + std::to_string(n_) + " keyframes want " + std::to_string(wanted) +
                      " values, and there are " + std::to_string(there));
  }

  // The i-th of `n` elements of the two keyframes.
  template <class Values>
  auto from(const Values& values, std::size_t i = 0, std::size_t n = 1) const {
    return values[at(place_.from, 1, i, n)];
  }
  template <class Values>
  auto to(const Values& values, std::size_t i = 0, std::size_t n = 1) const {
    return values[at(place_.to, 1, i, n)];
  }

  // A keyframe of a cubic has the slope before it, its value, and the slope behind it.
  template <class Values>
  auto cubic(const Values& values, std::size_t i = 0, std::size_t n = 1) const {
    const Hermite h(place_);
    return h.from * from(values, i, n) + h.from_slope * values[at(place_.from, 2, i, n)] +
           h.to * to(values, i, n) + h.to_slope * values[at(place_.to, 0, i, n)];
  }

 private:
  std::size_t at(std::size_t keyframe, std::size_t part, std::size_t i, std::size_t n) const {
    return way_ == Way::cubic ? (3 * keyframe + part) * n + i : keyframe * n + i;
  }

  const JsonNode& node_;
  const JsonNode& output_;
  Way way_;
  std::size_t n_ = 0;
  Place place_;
};

glm::dquat unit(const glm::dquat& q) {
  const double length = glm::length(q);
  return std::isfinite(length) && length > 0 ? q / length : glm::dquat(1, 0, 0, 0);
}

}  // namespace

glm::dquat slerp(const glm::dquat& from, const glm::dquat& to, double t) {
  const double dot = glm::dot(from, to), sign = dot < 0 ? -1 : 1;
  const double angle = std::acos(std::min(std::abs(dot), 1.0));
  // The arc and the chord of a small angle are the same.
  if (angle < 1e-6) return unit(from * (1 - t) + to * (sign * t));
  return unit(from * std::sin(angle * (1 - t)) + to * (sign * std::sin(angle * t)));
}

dvec3 vector_at(Document& document, const JsonNode& sampler, double time) {
  const Sampler s(document, sampler, time);
  const auto values = read_vectors(document, s.output());
  s.expect(values.size(), 1);
  if (s.way() == Way::cubic) return s.cubic(values);
  const dvec3 from = s.from(values);
  return from + s.share() * (s.to(values) - from);
}

glm::dquat rotation_at(Document& document, const JsonNode& sampler, double time) {
  const Sampler s(document, sampler, time);
  const auto quads = read_quads(document, s.output());
  s.expect(quads.size(), 1);
  std::vector<glm::dquat> values;
  for (const auto& q : quads) values.emplace_back(q[3], q[0], q[1], q[2]);
  if (s.way() == Way::cubic) return unit(s.cubic(values));
  return slerp(unit(s.from(values)), unit(s.to(values)), s.share());
}

std::vector<double> weights_at(Document& document, const JsonNode& sampler, double time, std::size_t n) {
  const Sampler s(document, sampler, time);
  const auto values = read_scalars(document, s.output());
  s.expect(values.size(), n);
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) {
    const double from = s.from(values, i, n);
    out.push_back(s.way() == Way::cubic ? s.cubic(values, i, n)
                                        : from + s.share() * (s.to(values, i, n) - from));
  }
  return out;
}

}  // namespace kdray::scene::gltf
