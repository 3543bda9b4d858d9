#include "scene/import/gltf/gltf_pose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <span>
#include <vector>

#include "base/error.h"
#include "base/vec.h"
#include "scene/import/gltf/gltf_accessor.h"
#include "scene/import/gltf/gltf_document.h"
#include "scene/import/text_scanner.h"

namespace kdray::scene::gltf {

// ---- What an animation sampler says at a time, in seconds: LINEAR, STEP and CUBICSPLINE, rotations along
// the shorter arc (glTF 2.0, 3.11 and appendix C). Before the first keyframe the value is the first one's,
// behind the last one the last one's.

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

  // Returns the i-th of `n` elements of the two keyframes.
  template <class Values>
  auto from(const Values& values, std::size_t i = 0, std::size_t n = 1) const {
    return values[at(place_.from, 1, i, n)];
  }
  template <class Values>
  auto to(const Values& values, std::size_t i = 0, std::size_t n = 1) const {
    return values[at(place_.to, 1, i, n)];
  }

  // Interpolates a cubic, whose keyframes have the slope before them, the value, and the slope behind them.
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

// Returns the unit quaternion a share `t` of the way from one to another, where -q is the same rotation as q.
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

// Returns one weight for each of `n` morph targets.
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

}  // namespace

// ---- The pose

namespace {

constexpr std::size_t kNoParent = ~std::size_t{0};
constexpr std::size_t kMostTargets = 4096;

// Returns `key`'s N numbers, or nothing when the object has no such key.
template <std::size_t N>
std::optional<std::array<double, N>> numbers(const JsonNode& object, std::string_view key) {
  const auto node = object.find(key);
  if (!node) return std::nullopt;
  const std::vector<JsonNode> parts = node->elements();
  if (parts.size() != N) throw node->expected(std::to_string(N) + " numbers");
  std::array<double, N> out;
  for (std::size_t i = 0; i < N; ++i) out[i] = parts[i].number();
  return out;
}

std::optional<dvec3> vector_of(const JsonNode& node, std::string_view key) {
  const auto v = numbers<3>(node, key);
  return v ? std::optional(dvec3((*v)[0], (*v)[1], (*v)[2])) : std::nullopt;
}

std::optional<glm::dquat> rotation_of(const JsonNode& node) {
  const auto q = numbers<4>(node, "rotation");
  return q ? std::optional(glm::dquat((*q)[3], (*q)[0], (*q)[1], (*q)[2])) : std::nullopt;
}

std::vector<double> list_of(const JsonNode& node) {
  std::vector<double> out;
  for (const JsonNode& part : node.elements()) out.push_back(part.number());
  return out;
}

std::string name_of_animation(const JsonNode& animation) {
  const auto name = animation.find("name");
  return name ? name->string() : "";
}

std::string list_of_animations(const std::vector<JsonNode>& animations) {
  std::string out;
  for (std::size_t i = 0; i < animations.size() && i < 20; ++i) {
    const std::string name = name_of_animation(animations[i]);
    out += fmt::format("{}{}", i == 0 ? "" : ", ", i) + (name.empty() ? "" : " '" + printable(name) + "'");
  }
  return animations.size() > 20 ? out + ", ..." : out;
}

}  // namespace

std::size_t target_count(const JsonNode& mesh) {
  std::size_t n = 0;
  for (const JsonNode& primitive : mesh["primitives"].elements())
    if (const auto targets = primitive.find("targets")) n = std::max(n, targets->elements().size());
  if (n > kMostTargets) throw mesh.error("more than " + std::to_string(kMostTargets) + " morph targets");
  return n;
}

Pose::Pose(Document& document, const LoadOptions& options) : document_(document) {
  if (!options.time) return;
  for (const JsonNode& animation : chosen(options)) play(animation, *options.time);
  if (n_left_out_ > 0)
    warnings_.push_back(
        fmt::format("{} animated {} of something else than nodes (KHR_animation_pointer) {} left out",
                    n_left_out_, n_left_out_ == 1 ? "value" : "values", n_left_out_ == 1 ? "is" : "are"));
}

std::vector<JsonNode> Pose::chosen(const LoadOptions& options) {
  const std::vector<JsonNode>& all = document_.entries("animations");
  if (all.empty()) warnings_.emplace_back("there is no animation: at any time it is the same");
  if (all.empty() || options.animation == "all") return all;
  if (options.animation.empty()) {
    if (all.size() > 1)
      warnings_.push_back(
          fmt::format("of {} animations the first is seen; --animation names another, or all: {}", all.size(),
                      list_of_animations(all)));
    return {all.front()};
  }
  for (std::size_t i = 0; i < all.size(); ++i)
    if (options.animation == std::to_string(i) || options.animation == name_of_animation(all[i]))
      return {all[i]};
  throw Error(ErrorCode::usage, "there is no animation '" + printable(options.animation) +
                                    "': " + document_.file() + " has " + list_of_animations(all));
}

void Pose::play(const JsonNode& animation, double time) {
  const std::vector<JsonNode> samplers = animation["samplers"].elements();
  for (const JsonNode& channel : animation["channels"].elements()) {
    const std::uint64_t i = whole(channel["sampler"]);
    if (i >= samplers.size()) throw channel["sampler"].error("there is no such sampler");
    play(channel, samplers[i], time);
  }
}

void Pose::play(const JsonNode& channel, const JsonNode& sampler, double time) {
  const JsonNode target = channel["target"];
  const std::string path = target["path"].string();
  const auto index = target.find("node");
  if (!index) {  // it moves nothing, or what an extension names
    n_left_out_ += path == "pointer";
    return;
  }
  const JsonNode& node = document_.entry("nodes", *index);
  Moved& moved = moved_[node.id()];
  if (path == "translation") {
    moved.translation = vector_at(document_, sampler, time);
  } else if (path == "scale") {
    moved.scale = vector_at(document_, sampler, time);
  } else if (path == "rotation") {
    moved.rotation = rotation_at(document_, sampler, time);
  } else if (path == "weights") {
    const auto mesh = node.find("mesh");
    if (!mesh) throw target.error("the node has no mesh to morph");
    moved.weights = weights_at(document_, sampler, time, target_count(document_.entry("meshes", *mesh)));
  } else {
    throw target["path"].expected("translation, rotation, scale or weights");
  }
}

dmat4 Pose::local(const JsonNode& node) const {
  dmat4 m(1);
  const auto found = moved_.find(node.id());
  const Moved* const moved = found == moved_.end() ? nullptr : &found->second;
  const bool turned = moved && (moved->translation || moved->rotation || moved->scale);
  if (const auto matrix = numbers<16>(node, "matrix"); matrix && !turned) {
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = (*matrix)[static_cast<std::size_t>(i)];
    return m;
  }
  const auto rotation = moved && moved->rotation ? moved->rotation : rotation_of(node);
  const auto scale = moved && moved->scale ? moved->scale : vector_of(node, "scale");
  const auto move = moved && moved->translation ? moved->translation : vector_of(node, "translation");
  if (rotation && glm::length(*rotation) > 0) m = glm::mat4_cast(glm::normalize(*rotation));
  if (scale)
    for (int i = 0; i < 3; ++i) m[i] *= (*scale)[i];
  if (move) m[3] = glm::dvec4(*move, 1);
  return m;
}

void Pose::find_parents() {
  const std::vector<JsonNode>& nodes = document_.entries("nodes");
  parents_.assign(nodes.size(), kNoParent);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (const auto children = nodes[i].find("children"))
      for (const JsonNode& child : children->elements())
        if (const std::uint64_t at = whole(child); at < nodes.size()) parents_[at] = i;
}

// Goes up to a node whose place is known, and down again.
dmat4 Pose::to_world(const JsonNode& node_index) {
  const std::vector<JsonNode>& nodes = document_.entries("nodes");
  document_.entry("nodes", node_index);
  if (parents_.empty()) find_parents();
  std::vector<std::size_t> open;
  std::size_t at = whole(node_index);
  while (at != kNoParent && !worlds_.contains(at)) {
    if (open.size() == nodes.size()) throw node_index.error("the node is inside itself");
    open.push_back(at);
    at = parents_[at];
  }
  dmat4 m = at == kNoParent ? dmat4(1) : worlds_.at(at);
  for (auto it = open.rbegin(); it != open.rend(); ++it) worlds_[*it] = m = m * local(nodes[*it]);
  return m;
}

std::vector<double> Pose::weights(const JsonNode& node, const JsonNode& mesh) const {
  const std::size_t n = target_count(mesh);
  if (n == 0) return {};
  std::vector<double> out;
  if (const auto found = moved_.find(node.id()); found != moved_.end() && found->second.weights)
    out = *found->second.weights;
  else if (const auto own = node.find("weights"))
    out = list_of(*own);
  else if (const auto meshs = mesh.find("weights"))
    out = list_of(*meshs);
  out.resize(n);
  return std::ranges::all_of(out, [](double w) { return w == 0; }) ? std::vector<double>{} : out;
}

}  // namespace kdray::scene::gltf
