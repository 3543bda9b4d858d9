#include "bench/modes/lives.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kdray::bench {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double largest(const vec3& v) {
  return std::max({v.x, v.y, v.z});
}

// What a ray carries besides its place in the tree of lives.
struct Bearing {
  vec3 weight{1};
  bool inside = false;  // of something transparent
};

class Making {
 public:
  Making(const scene::Scene& scene, const LifeOptions& options, const Tracer& trace)
      : scene_(scene), options_(options), trace_(trace), surfaces_(scene), offset_(offset_of(scene)) {}

  std::vector<LifeRay> make() {
    look();
    for (std::size_t first = 0; first < lives_.size();) {
      const std::size_t end = lives_.size();
      const std::vector<Hit> hits = run_to_ends(first, end);
      for (std::size_t i = first; i < end; ++i)
        if (is_shaded(lives_[i])) shade(i, hits[i - first]);
      first = end;
    }
    return std::move(lives_);
  }

 private:
  // The eye rays, line by line.
  void look() {
    const scene::Camera camera = scene_.camera.value_or(scene::Camera{});
    const CameraBasis view(camera);
    const double scale = view.half_height, height = options_.height;
    for (int y = 0; y < options_.height; ++y)
      for (int x = 0; x < options_.width; ++x) {
        const double across = scale * (2 * (x + 0.5) - options_.width) / height;
        const double above = scale * (1 - 2 * (y + 0.5) / height);
        const dvec3 along = view.forward + view.right * across + view.up * above;
        put(make_ray(camera.from, along, kInfinity, camera.hither), kNoParent, 1, LifeKind::primary, {});
      }
  }

  void put(const Ray& ray, std::uint32_t parent, int depth, LifeKind kind, const Bearing& bearing) {
    lives_.push_back({ray, parent, static_cast<std::uint8_t>(depth), kind});
    bearings_.push_back(bearing);
  }

  std::vector<Hit> run_to_ends(std::size_t first, std::size_t end) {
    std::vector<Ray> rays;
    for (std::size_t i = first; i < end; ++i) rays.push_back(lives_[i].ray);
    const std::vector<Hit> hits = trace_(rays);
    for (std::size_t i = first; i < end; ++i) {
      const Hit& hit = hits[i - first];
      lives_[i].hit = hit.primitive >= 0;
      if (lives_[i].hit) lives_[i].ray.t_max = hit.t;
    }
    return hits;
  }

  void shade(std::size_t at, const Hit& hit) {
    const LifeRay life = lives_[at];
    const Meeting met(surfaces_, life.ray, hit);
    light_up(at, met.position + met.normal * offset_, met.normal);
    if (life.depth < options_.depth) spawn(at, hit, met);
  }

  void light_up(std::size_t at, const dvec3& from, const dvec3& normal) {
    for (const scene::Light& light : scene_.lights) {
      const bool far_away = light.kind == scene::LightKind::directional;
      const dvec3 to_light = far_away ? -light.direction : light.position - from;
      const double distance = glm::length(to_light);
      if (!(glm::dot(to_light, normal) > 0) || (!far_away && distance > light.range)) continue;
      put(make_ray(from, to_light, far_away ? kInfinity : 1), static_cast<std::uint32_t>(at),
          lives_[at].depth, LifeKind::shadow, {});
    }
  }

  void spawn(std::size_t at, const Hit& hit, const Meeting& met) {
    const scene::Material& material = surfaces_.material(static_cast<std::uint32_t>(hit.primitive));
    const Bearing bearing = bearings_[at];
    const int depth = lives_[at].depth + 1;
    const auto parent = static_cast<std::uint32_t>(at);
    vec3 reflect = material.reflect;
    if (largest(material.transmit) > 0) {
      const double ratio = bearing.inside ? material.index : 1 / material.index;
      const dvec3 refracted = glm::refract(met.incoming, met.normal, ratio);
      if (glm::dot(refracted, refracted) > 0.5) {
        const vec3 weight = bearing.weight * material.transmit;
        if (carries(weight))
          put(make_ray(met.position - met.normal * offset_, refracted, kInfinity), parent, depth,
              LifeKind::refracted, {weight, !bearing.inside});
      } else {
        reflect += material.transmit;  // total reflection
      }
    }
    const vec3 weight = bearing.weight * reflect;
    if (carries(weight))
      put(make_ray(met.position + met.normal * offset_, glm::reflect(met.incoming, met.normal), kInfinity),
          parent, depth, LifeKind::reflected, {weight, bearing.inside});
  }

  bool carries(const vec3& weight) const {
    return largest(weight) > 0 && largest(weight) >= options_.least_weight;
  }

  const scene::Scene& scene_;
  const LifeOptions& options_;
  const Tracer& trace_;
  Surfaces surfaces_;
  double offset_;
  std::vector<LifeRay> lives_;
  std::vector<Bearing> bearings_;  // of each
};

}  // namespace

std::vector<LifeRay> make_lives(const scene::Scene& scene, const LifeOptions& options, const Tracer& trace) {
  return Making(scene, options, trace).make();
}

}  // namespace kdray::bench
