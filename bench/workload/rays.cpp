#include "bench/workload/rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "bench/workload/pixel_order.h"
#include "scene/generate/random.h"

namespace kdray::bench {

namespace {

constexpr std::array<std::string_view, 7> kNames = {"primary",   "scanline", "shadow", "mirror",
                                                    "refracted", "diffuse",  "random"};
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kGlass = 1.5;  // the index of refraction of everything

dvec3 double_of(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

// Primary rays go through the pixels' centres, from `hither` along the view direction on.
std::vector<Ray> primary(const scene::Camera& camera, const std::vector<Pixel>& pixels, int side) {
  const CameraBasis view(camera);
  const double scale = view.half_height;
  std::vector<Ray> rays;
  rays.reserve(pixels.size());
  for (const Pixel& p : pixels) {
    const double x = scale * (2 * (p.x + 0.5) / side - 1), y = scale * (1 - 2 * (p.y + 0.5) / side);
    rays.push_back(
        make_ray(camera.from, view.forward + view.right * x + view.up * y, kInfinity, camera.hither));
  }
  return rays;
}

std::vector<Meeting> meetings(const scene::Scene& scene, const std::vector<Ray>& rays,
                              const std::vector<Hit>& hits) {
  const Surfaces surfaces(scene);
  std::vector<Meeting> found;
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (hits[i].primitive >= 0) found.emplace_back(surfaces, rays[i], hits[i]);
  return found;
}

// Shadow rays go to the first light; a renderer does not ask for lights behind the surface.
std::vector<Ray> shadow(const scene::Scene& scene, const std::vector<Meeting>& met, double offset) {
  std::vector<Ray> rays;
  if (scene.lights.empty()) return rays;
  const scene::Light& light = scene.lights.front();
  const bool far_away = light.kind == scene::LightKind::directional;
  for (const Meeting& m : met) {
    const dvec3 from = m.position + m.normal * offset;
    const dvec3 to_light = far_away ? -light.direction : light.position - from;
    if (glm::dot(to_light, m.normal) > 0) rays.push_back(make_ray(from, to_light, far_away ? kInfinity : 1));
  }
  return rays;
}

std::vector<Ray> mirror(const std::vector<Meeting>& met, double offset) {
  std::vector<Ray> rays;
  for (const Meeting& m : met)
    rays.push_back(make_ray(m.position + m.normal * offset, glm::reflect(m.incoming, m.normal), kInfinity));
  return rays;
}

std::vector<Ray> refracted(const std::vector<Meeting>& met, double offset) {
  std::vector<Ray> rays;
  for (const Meeting& m : met)
    rays.push_back(
        make_ray(m.position - m.normal * offset, glm::refract(m.incoming, m.normal, 1 / kGlass), kInfinity));
  return rays;
}

// Cosine about the normal: the unit sphere that touches the surface, seen from the point of touch.
std::vector<Ray> diffuse(const std::vector<Meeting>& met, double offset) {
  generate::Random random(1);
  std::vector<Ray> rays;
  for (const Meeting& m : met) {
    dvec3 direction = m.normal + random.direction();
    if (glm::length(direction) < 1e-6) direction = m.normal;  // straight down: no direction
    rays.push_back(make_ray(m.position + m.normal * offset, direction, kInfinity));
  }
  return rays;
}

std::vector<Ray> random_rays(const DBox& bounds, std::size_t n) {
  generate::Random random(2);
  std::vector<Ray> rays;
  rays.reserve(n);
  for (std::size_t i = 0; i < n && !bounds.empty(); ++i) {
    const dvec3 origin = random.in_box(bounds.lo, bounds.hi);
    rays.push_back(make_ray(origin, random.direction(), kInfinity));
  }
  return rays;
}

}  // namespace

std::span<const std::string_view> class_names() {
  return kNames;
}

double offset_of(const scene::Scene& scene) {
  const DBox bounds = scene.bounds();
  if (bounds.empty()) return 0;
  const dvec3 reach = glm::max(glm::abs(bounds.lo), glm::abs(bounds.hi));
  return 0x1p-16 * std::max({glm::length(bounds.extent()), reach.x, reach.y, reach.z});
}

int side_of(int rays) {
  return std::max(1, static_cast<int>(std::sqrt(static_cast<double>(rays))));
}

CameraBasis::CameraBasis(const scene::Camera& camera)
    : forward(glm::normalize(camera.at - camera.from)),
      right(glm::normalize(glm::cross(forward, camera.up))),
      up(glm::cross(right, forward)),
      half_height(std::tan(camera.vertical_fov / 2)) {}

Ray make_ray(const dvec3& origin, const dvec3& along, double t_max, double t_min) {
  const double length = glm::length(along);
  Ray ray{};
  for (int k = 0; k < 3; ++k) {
    ray.origin[k] = static_cast<float>(origin[k]);
    ray.direction[k] = static_cast<float>(along[k] / length);
  }
  ray.t_min = static_cast<float>(t_min * length);
  ray.t_max = static_cast<float>(t_max * length);
  return ray;
}

Meeting::Meeting(const Surfaces& surfaces, const Ray& ray, const Hit& hit) {
  const dvec3 direction = double_of(ray.direction);
  position = double_of(ray.origin) + direction * double{hit.t};
  incoming = glm::normalize(direction);
  normal = surfaces.normal(static_cast<std::uint32_t>(hit.primitive), position);
  if (glm::dot(normal, direction) > 0) normal = -normal;
}

std::vector<RayClass> make_classes(const scene::Scene& scene, std::span<const std::string> names, int side,
                                   const Tracer& trace) {
  const scene::Camera camera = scene.camera.value_or(scene::Camera{});
  const double offset = offset_of(scene);
  const std::vector<Pixel> pixels = morton_order(side);
  const std::vector<Ray> eye_rays = primary(camera, pixels, side);
  const std::vector<Meeting> met = meetings(scene, eye_rays, trace(eye_rays));
  const auto rays_of = [&](std::string_view name) {
    if (name == "primary") return eye_rays;
    if (name == "scanline") return primary(camera, scanline_order(side), side);
    if (name == "shadow") return shadow(scene, met, offset);
    if (name == "mirror") return mirror(met, offset);
    if (name == "refracted") return refracted(met, offset);
    if (name == "diffuse") return diffuse(met, offset);
    return random_rays(scene.bounds(), pixels.size());
  };
  std::vector<RayClass> classes;
  for (const std::string_view name : kNames)
    if (std::find(names.begin(), names.end(), name) != names.end())
      classes.push_back({std::string(name), name == "shadow", rays_of(name)});
  return classes;
}

}  // namespace kdray::bench
