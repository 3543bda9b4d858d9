#include "oracle/whitted.h"

#include "oracle/sky.h"

#include <algorithm>
#include <cmath>

namespace kdray::oracle {
namespace {

// Two surfaces closer together than this share of the scene are one to a secondary ray; far below what float
// resolves, far above what double loses.
constexpr double kClearance = 1e-9;

enum LightState { kBehind, kOutOfReach, kShadowed, kLit };
constexpr int kTotalReflection = -2;

double attenuation(const scene::Light& light, double distance) {
  if (light.kind == scene::LightKind::directional) return 1;
  if (distance > light.range) return 0;
  const dvec3 a(light.attenuation);
  return 1 / (a.x + a.y * distance + a.z * distance * distance);
}

double spot_factor(const scene::Light& light, const dvec3& to_light) {
  if (light.kind != scene::LightKind::spot) return 1;
  const double cosine = -glm::dot(to_light, light.direction);
  const double inner = light.cos_inner, outer = light.cos_outer;
  if (inner <= outer) return cosine >= outer ? 1 : 0;
  const double s = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
  return s * s;
}

dvec3 mirrored(const dvec3& d, const dvec3& n) {
  return d - 2 * glm::dot(d, n) * n;
}

// What a ray sees that meets nothing, by the definition of the sky.
dvec3 seen_beyond(const scene::Scene& scene, const dvec3& direction) {
  if (scene.sky.kind == scene::SkyKind::none) return dvec3(scene.background);
  if (scene.sky.kind == scene::SkyKind::gradient)
    return gradient(scene.sky, glm::dot(glm::normalize(direction), scene.sky.up));
  return sky_picture(scene.sky, glm::normalize(direction));
}

double largest(const dvec3& v) {
  return std::max({v.x, v.y, v.z});
}

}  // namespace

struct Whitted::Tree {
  Path& path;
  RayCounts& counts;
};

struct Whitted::Shading {
  dvec3 incoming;        // unit direction of the ray
  Surface surface;       // as the world gave it
  dvec3 ng, ns;          // normals towards the viewer
  dvec3 shadow_start;    // off the surface where the shading normals say it bulges
  bool entering = true;  // the viewer is outside
  int primitive = kNothing;
  const scene::Material* material = nullptr;
};

RayCounts& RayCounts::operator+=(const RayCounts& other) {
  primary += other.primary, primary_hit += other.primary_hit, shadow += other.shadow;
  reflected += other.reflected, refracted += other.refracted, light_in_front += other.light_in_front;
  return *this;
}

dvec3 Whitted::trace_eye(const Ray& ray, Path& path, RayCounts& counts) const {
  Tree tree{path, counts};
  ++counts.primary;
  const dvec3 color = trace(ray, 1, tree);
  if (path.front() != kNothing) ++counts.primary_hit;
  return color;
}

dvec3 Whitted::trace(const Ray& ray, int depth, Tree& tree) const {
  const Hit hit = world_.closest(ray);
  tree.path.push_back(hit.primitive);
  if (!hit.found()) return seen_beyond(scene_, ray.direction);

  const Shading s = prepare(ray, hit);
  const scene::Material& m = *s.material;
  dvec3 color = dvec3(m.emission) + dvec3(m.ambient) * dvec3(scene_.ambient) + direct(s, tree);
  if (depth >= depth_) return color;

  dvec3 reflect(m.reflect);
  const dvec3 transmit(m.transmit);
  if (largest(transmit) > 0) {
    const double eta = s.entering ? 1 / static_cast<double>(m.index) : static_cast<double>(m.index);
    const double cosine = -glm::dot(s.incoming, s.ns);
    const double k = 1 - eta * eta * (1 - cosine * cosine);
    if (k < 0) {
      tree.path.push_back(kTotalReflection);
      reflect += transmit;
    } else {
      dvec3 t = s.incoming;
      if (m.index != 1) t = eta * s.incoming + (eta * cosine - std::sqrt(k)) * s.ns;
      if (glm::dot(t, s.ng) >= 0) t = mirrored(t, s.ng);
      ++tree.counts.refracted;
      color += transmit * trace(spawn(s, t), depth + 1, tree);
    }
  }
  return color + reflected(s, reflect, depth, tree);
}

dvec3 Whitted::reflected(const Shading& s, const dvec3& share, int depth, Tree& tree) const {
  if (!(largest(share) > 0)) return dvec3(0);
  dvec3 r = mirrored(s.incoming, s.ns);
  if (glm::dot(r, s.ng) <= 0) r = mirrored(r, s.ng);
  ++tree.counts.reflected;
  return share * trace(spawn(s, r), depth + 1, tree);
}

Ray Whitted::spawn(const Shading& s, const dvec3& direction) const {
  Ray ray;
  ray.origin = s.surface.point;
  ray.direction = glm::normalize(direction);
  ray.t_min = kClearance * world_.extent();
  ray.self = s.primitive;
  return ray;
}

Whitted::Shading Whitted::prepare(const Ray& ray, const Hit& hit) const {
  Shading s;
  s.incoming = glm::normalize(ray.direction);
  s.surface = world_.surface(ray, hit);
  s.primitive = hit.primitive;
  s.material = &scene_.materials[s.surface.material];
  s.entering = glm::dot(s.surface.outward, s.incoming) <= 0;
  s.ng = s.entering ? s.surface.outward : -s.surface.outward;
  const double side = glm::dot(s.surface.shading, s.ng) >= 0 ? 1 : -1;
  s.ns = side * s.surface.shading;
  s.shadow_start = s.surface.point;
  if (s.surface.smooth) {
    for (int i = 0; i < 3; ++i) {
      const dvec3 n = side * s.surface.corner_normal[i];
      const double below = std::min(0.0, glm::dot(s.surface.point - s.surface.corner[i], n));
      s.shadow_start -= s.surface.weight[i] * below * n;
    }
  }
  return s;
}

dvec3 Whitted::direct(const Shading& s, Tree& tree) const {
  dvec3 sum(0);
  for (const scene::Light& l : scene_.lights) sum += light(s, l, tree);
  return sum;
}

dvec3 Whitted::light(const Shading& s, const scene::Light& light, Tree& tree) const {
  const bool directional = light.kind == scene::LightKind::directional;
  const dvec3 way = directional ? -light.direction : light.position - s.surface.point;
  const double distance = glm::length(way);
  if (distance == 0) return tree.path.push_back(kBehind), dvec3(0);
  const dvec3 l = way / distance;
  const double cosine = glm::dot(s.ns, l);
  if (!(cosine > 0)) return tree.path.push_back(kBehind), dvec3(0);
  ++tree.counts.light_in_front;
  const double factor = attenuation(light, distance) * spot_factor(light, l);
  const scene::Material& m = *s.material;
  const double aligned = std::max(0.0, glm::dot(mirrored(-l, s.ns), -s.incoming));
  const double highlight = aligned > 0 ? std::pow(aligned, static_cast<double>(m.shine)) : 0;
  const dvec3 color =
      factor * dvec3(light.color) * (cosine * dvec3(m.diffuse) + highlight * dvec3(m.specular));
  // What cannot be seen needs no shadow ray: a light out of reach, or one that could show nothing.
  if (!(largest(color) > 0)) return tree.path.push_back(kOutOfReach), dvec3(0);

  Ray ray;
  ray.origin = s.shadow_start;
  ray.direction = directional ? l : light.position - s.shadow_start;
  ray.t_min = kClearance * world_.extent() / glm::length(ray.direction);
  if (!directional) ray.t_max = 1 - kClearance;
  ray.self = s.primitive;
  ++tree.counts.shadow;
  const bool shadowed = world_.occluded(ray);
  tree.path.push_back(shadowed ? kShadowed : kLit);
  return shadowed ? dvec3(0) : color;
}

}  // namespace kdray::oracle
