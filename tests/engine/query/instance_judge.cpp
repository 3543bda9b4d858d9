#include "engine/query/instance_judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "scene/model/instances.h"

namespace kdray::test {

namespace {

constexpr double kU = 0x1p-24;

dvec3 vector(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

double largest_row(const dmat3& m) {
  double largest = 0;
  for (int row = 0; row < 3; ++row)
    largest = std::max(largest, std::abs(m[0][row]) + std::abs(m[1][row]) + std::abs(m[2][row]));
  return largest;
}

double largest(const dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// How far a segment is from the origin of the plane.
double distance_to(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 along = b - a;
  const double length = glm::dot(along, along);
  const double at = length > 0 ? std::clamp(-glm::dot(a, along) / length, 0.0, 1.0) : 0.0;
  return glm::length(a + at * along);
}

double turn(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

}  // namespace

InstanceJudge::InstanceJudge(const scene::Scene& scene) {
  const DBox box = scene.bounds();
  if (!box.empty()) middle_ = (box.lo + box.hi) * 0.5, reach_ = largest(box.hi - box.lo) * 0.5;
  add_part(scene, scene::kNone, dmat3(1), dvec3(0));
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& at = scene.instances[i];
    add_part(*scene.meshes[at.mesh], i, at.linear, at.move);
  }
}

void InstanceJudge::add_part(const scene::Scene& mesh, std::uint32_t instance, const dmat3& linear,
                             const dvec3& move) {
  Part part{.instance = instance, .triangles = {}, .mesh = &mesh, .linear = linear, .move = move};
  part.inverse = glm::inverse(linear);
  DBox own;
  for (const scene::Triangle& t : mesh.triangles) {
    Triangle copy{};
    for (std::size_t k = 0; k < 3; ++k) {
      const dvec3& v = mesh.vertices[t.vertex[k]];
      own.grow(v);
      copy.corner[k] = linear * v + move;
    }
    copy.number = t.number;
    const dvec3 normal = glm::cross(copy.corner[1] - copy.corner[0], copy.corner[2] - copy.corner[0]);
    if (normal != dvec3(0)) part.triangles.push_back(copy);
  }
  for (const scene::Sphere& s : mesh.spheres) own.grow(s.center - s.radius), own.grow(s.center + s.radius);
  if (own.empty()) return;
  part.place = linear * ((own.lo + own.hi) * 0.5) + move;
  part.size = largest_row(linear) * largest(own.hi - own.lo);
  part.condition = scene::condition_of(linear);
  parts_.push_back(std::move(part));
}

// By what the ray in a mesh may be off, in the scene; three times what is proved, since floats' own
// coordinates are off as well.
double InstanceJudge::error_of(const Part& part, const dvec3& origin) const {
  const double from = largest(origin - part.place) + part.size;
  return kU * (128 * part.condition * from + 32 * (largest(origin - middle_) + reach_));
}

template <class Take>
void InstanceJudge::for_each_met(const Ray& ray, const Take& take) const {
  const dvec3 o = vector(ray.origin), d = vector(ray.direction);
  const double length = glm::length(d);
  const dvec3 along = d / length;
  const dvec3 aside = glm::normalize(std::abs(along.x) < 0.6 ? glm::cross(along, dvec3(1, 0, 0))
                                                             : glm::cross(along, dvec3(0, 1, 0)));
  const dvec3 up = glm::cross(along, aside);
  for (const Part& part : parts_) {
    const double error = error_of(part, o);
    const dvec3 to = part.place - o;
    if (glm::length(to - glm::dot(to, along) * along) > 3 * part.size + error) continue;
    for (const Triangle& t : part.triangles) {
      glm::dvec2 p[3];
      for (int k = 0; k < 3; ++k) p[k] = {glm::dot(t.corner[k] - o, aside), glm::dot(t.corner[k] - o, up)};
      const double a = turn(p[1], p[2]), b = turn(p[2], p[0]), c = turn(p[0], p[1]);
      const bool inside = (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
      const double edge =
          std::min({distance_to(p[0], p[1]), distance_to(p[1], p[2]), distance_to(p[2], p[0])});
      if (!inside && edge > error) continue;
      const dvec3 normal = glm::normalize(glm::cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]));
      const double slope = std::max(std::abs(glm::dot(normal, along)), 1e-12);
      Met met{true, inside && edge > error};
      met.t = glm::dot(t.corner[0] - o, normal) / glm::dot(normal, along) / length;
      met.error = 2 * error / slope / length;
      if (!std::isfinite(met.t)) met.t = 0, met.error = std::numeric_limits<double>::infinity();
      take(part.instance, t.number, met);
    }
    const dvec3 from = part.inverse * (o - part.move), there = part.inverse * d;
    const double speed = glm::length(there), off = error * largest_row(part.inverse) * 2;
    for (const scene::Sphere& s : part.mesh->spheres) {
      const dvec3 to_center = s.center - from;
      const double nearest = glm::dot(to_center, there) / speed;
      const double pass = glm::length(to_center - nearest * there / speed);
      if (pass > s.radius + off) continue;
      const auto half = [&](double at) { return std::sqrt(std::max(0.0, s.radius * s.radius - at * at)); };
      Met met{true, pass < s.radius - off};
      met.error = (half(std::max(0.0, pass - off)) - half(pass + off) + off) / speed;
      for (const double side : {-1.0, 1.0}) {
        met.t = (nearest + side * half(pass)) / speed;
        take(part.instance, s.number, met);
      }
    }
  }
}

std::string InstanceJudge::wrong(const Ray& ray, const Hit& hit, std::uint32_t instance) const {
  const bool missed = hit.primitive < 0;
  double latest = std::numeric_limits<double>::infinity();  // that the closest hit may be
  std::uint32_t by_instance = 0, by_number = 0;
  bool confirmed = false;
  for_each_met(ray, [&](std::uint32_t i, std::uint32_t number, const Met& met) {
    const bool counts = met.t - met.error > ray.t_min && met.t + met.error < ray.t_max;
    if (met.certain && counts && met.t + met.error < latest)
      latest = met.t + met.error, by_instance = i, by_number = number;
    if (!missed && i == instance && number == static_cast<std::uint32_t>(hit.primitive))
      confirmed |= std::abs(met.t - hit.t) <= met.error;
  });
  if (missed) {
    if (instance != scene::kNone) return "a miss in an instance";
    if (std::isinf(latest)) return {};
    return fmt::format("missed primitive {} of instance {} at {}", by_number, by_instance, latest);
  }
  if (!confirmed)
    return fmt::format("primitive {} of instance {} isn't hit at {}", hit.primitive, instance, hit.t);
  if (hit.t > latest)
    return fmt::format("primitive {} of instance {} at {} lies before that of {} at {}", by_number,
                       by_instance, latest, instance, hit.t);
  return {};
}

std::string InstanceJudge::wrong(const Ray& ray, std::span<const Crossing> crossings) const {
  for (std::size_t i = 1; i < crossings.size(); ++i) {
    const Crossing &a = crossings[i - 1], &b = crossings[i];
    // What is in no instance goes first.
    const auto key = [](const Crossing& c) { return std::tuple(c.t, c.instance + 1, c.primitive); };
    if (!(key(a) < key(b))) return fmt::format("hit {} comes before hit {}", i, i - 1);
  }
  std::vector<int> told(crossings.size(), 0);
  std::string missing;
  for_each_met(ray, [&](std::uint32_t i, std::uint32_t number, const Met& met) {
    bool found = false;
    for (std::size_t k = 0; k < crossings.size(); ++k) {
      const Crossing& c = crossings[k];
      if (c.instance != i || c.primitive != number || std::abs(met.t - c.t) > met.error) continue;
      ++told[k];
      found = true;
    }
    const bool counts = met.t - met.error > ray.t_min && met.t + met.error < ray.t_max;
    if (met.certain && counts && !found)
      missing = fmt::format("primitive {} of instance {} at {} is missing", number, i, met.t);
  });
  if (!missing.empty()) return missing;
  for (std::size_t k = 0; k < crossings.size(); ++k)
    if (told[k] == 0)
      return fmt::format("primitive {} of instance {} isn't hit at {}", crossings[k].primitive,
                         crossings[k].instance, crossings[k].t);
  return {};
}

}  // namespace kdray::test
