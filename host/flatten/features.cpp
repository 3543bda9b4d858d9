#include "flatten/features.h"

#include <algorithm>
#include <cmath>

#include "layout/features.h"

namespace kdray::flatten {

namespace {

constexpr Feature kFeatures[] = {
    {KDRAY_FEATURE_TRIANGLES, "triangles"},
    {KDRAY_FEATURE_SPHERES, "spheres"},
    {KDRAY_FEATURE_CONES, "cones"},
    {KDRAY_FEATURE_SMOOTH, "smooth normals"},
    {KDRAY_FEATURE_NUMBERS, "primitive numbers"},
    {KDRAY_FEATURE_REFLECT, "reflection"},
    {KDRAY_FEATURE_TRANSMIT, "refraction"},
    {KDRAY_FEATURE_SPECULAR, "highlights"},
    {KDRAY_FEATURE_DIFFUSE, "diffuse"},
    {KDRAY_FEATURE_LIGHTS, "lights"},
    {KDRAY_FEATURE_ATTENUATION, "attenuation"},
    {KDRAY_FEATURE_DIRECTIONAL, "directional"},
    {KDRAY_FEATURE_SPOT, "spot"},
    {KDRAY_FEATURE_FACES, "faces"},
    {KDRAY_FEATURE_BACKGROUND, "background"},
    {KDRAY_FEATURE_SUPERSAMPLE, "supersampling"},
    {KDRAY_FEATURE_ADAPTIVE, "adaptive sampling"},
};

std::uint32_t when(bool needed, std::uint32_t bit) {
  return needed ? bit : 0;
}
bool any(const vec3& color) {
  return glm::any(glm::greaterThan(color, vec3(0)));
}

template <class Items, class Predicate>
bool some(const Items& items, Predicate predicate) {
  return std::any_of(items.begin(), items.end(), predicate);
}

// True when each primitive's place in the file is its index in its kind's array: one kind, and none dropped.
bool numbers_are_indices(const scene::Scene& scene, const scene::Geometry& geometry) {
  const auto in_order = [](const auto& kept, const auto& number_of) {
    for (std::size_t i = 0; i < kept.size(); ++i)
      if (number_of(kept[i]) != i) return false;
    return true;
  };
  return in_order(geometry.triangles, [](const auto& t) { return t.number; }) &&
         in_order(geometry.spheres, [&](const auto& s) { return scene.spheres[s.source].number; }) &&
         in_order(geometry.cones, [&](const auto& c) { return scene.cones[c.source].number; });
}

std::uint32_t geometry_features(const scene::Scene& scene, const scene::Geometry& geometry) {
  return when(!numbers_are_indices(scene, geometry), KDRAY_FEATURE_NUMBERS) |
         when(!geometry.triangles.empty(), KDRAY_FEATURE_TRIANGLES) |
         when(!geometry.spheres.empty(), KDRAY_FEATURE_SPHERES) |
         when(!geometry.cones.empty(), KDRAY_FEATURE_CONES) |
         when(geometry.n_smooth > 0, KDRAY_FEATURE_SMOOTH);
}

// A material counts only when a primitive wears it.
std::uint32_t material_features(const scene::Scene& scene, const scene::Geometry& geometry) {
  std::vector<bool> used(scene.materials.size(), false);
  for (const auto& t : geometry.triangles) used[t.material] = true;
  for (const auto& s : geometry.spheres) used[scene.spheres[s.source].material] = true;
  for (const auto& c : geometry.cones) used[scene.cones[c.source].material] = true;
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    const scene::Material& m = scene.materials[i];
    mask |= when(any(m.reflect), KDRAY_FEATURE_REFLECT) | when(any(m.transmit), KDRAY_FEATURE_TRANSMIT) |
            when(any(m.specular), KDRAY_FEATURE_SPECULAR) | when(any(m.diffuse), KDRAY_FEATURE_DIFFUSE);
  }
  return mask;
}

bool attenuated(const scene::Light& l) {
  return l.attenuation != dvec3(1, 0, 0) || std::isfinite(l.range);
}

}  // namespace

std::uint32_t features_of(const scene::Scene& scene, const scene::Geometry& geometry) {
  std::uint32_t mask = geometry_features(scene, geometry) | material_features(scene, geometry) |
                       when(any(scene.background), KDRAY_FEATURE_BACKGROUND);
  if (!(mask & (KDRAY_FEATURE_DIFFUSE | KDRAY_FEATURE_SPECULAR)))
    return mask;  // nothing that light could change
  for (const scene::Light& light : scene.lights)
    mask |= KDRAY_FEATURE_LIGHTS | when(attenuated(light), KDRAY_FEATURE_ATTENUATION) |
            when(light.kind == scene::LightKind::directional, KDRAY_FEATURE_DIRECTIONAL) |
            when(light.kind == scene::LightKind::spot, KDRAY_FEATURE_SPOT);
  return mask;
}

std::uint32_t features_of_samples(int samples, bool adaptive) {
  return when(samples > 1, KDRAY_FEATURE_SUPERSAMPLE) | when(adaptive, KDRAY_FEATURE_ADAPTIVE);
}

std::span<const Feature> features() {
  return kFeatures;
}

FeatureNames feature_names(std::uint32_t mask) {
  FeatureNames names;
  for (const Feature& f : kFeatures) (mask & f.bit ? names.on : names.off).push_back(f.name);
  return names;
}

}  // namespace kdray::flatten
