#include "accel/flatten/features.h"

#include <algorithm>
#include <cmath>

#include "layout/features.h"

namespace kdray::flatten {

namespace {

constexpr Feature kFeatures[] = {
#define KDRAY_NAMED_KIND(NAME, name, names, Struct) {KDRAY_FEATURE_OF_KIND(KDRAY_KIND_##NAME), #names},
    KDRAY_KINDS(KDRAY_NAMED_KIND)
#undef KDRAY_NAMED_KIND
        {KDRAY_FEATURE_SMOOTH, "smooth normals"},
    {KDRAY_FEATURE_ZERO_AREA, "stitches"},
    {KDRAY_FEATURE_NUMBERS, "primitive numbers"},
    {KDRAY_FEATURE_MATERIAL_MAPS, "material maps"},
    {KDRAY_FEATURE_CORNER_COLORS, "corner colours"},
    {KDRAY_FEATURE_TEXTURES, "textures"},
    {KDRAY_FEATURE_CUTOUTS, "cut-outs"},
    {KDRAY_FEATURE_FOOTPRINTS, "footprints"},
    {KDRAY_FEATURE_METAL_MAPS, "metal maps"},
    {KDRAY_FEATURE_NORMAL_MAPS, "normal maps"},
    {KDRAY_FEATURE_LIGHT_MAPS, "light maps"},
    {KDRAY_FEATURE_REFLECT, "reflection"},
    {KDRAY_FEATURE_TRANSMIT, "refraction"},
    {KDRAY_FEATURE_SPECULAR, "highlights"},
    {KDRAY_FEATURE_DIFFUSE, "diffuse"},
    {KDRAY_FEATURE_LIGHTS, "lights"},
    {KDRAY_FEATURE_ATTENUATION, "attenuation"},
    {KDRAY_FEATURE_DIRECTIONAL, "directional"},
    {KDRAY_FEATURE_SPOT, "spot"},
    {KDRAY_FEATURE_FACES, "faces"},
    {KDRAY_FEATURE_SKY, "sky"},
    {KDRAY_FEATURE_FLOOR, "floor"},
    {KDRAY_FEATURE_AREA_LIGHTS, "area lights"},
    {KDRAY_FEATURE_LENS, "lens"},
    {KDRAY_FEATURE_INSTANCES, "instances"},
    {KDRAY_FEATURE_BACKGROUND, "background"},
    {KDRAY_FEATURE_SUPERSAMPLE, "supersampling"},
    {KDRAY_FEATURE_ADAPTIVE, "adaptive sampling"},
};

Features when(bool needed, Features bit) {
  return needed ? bit : 0;
}
bool any(const vec3& color) {
  return glm::any(glm::greaterThan(color, vec3(0)));
}

template <class Items, class Predicate>
bool some(const Items& items, Predicate predicate) {
  return std::any_of(items.begin(), items.end(), predicate);
}

// Returns whether each primitive's place in the file is its index in its kind's array: one kind, and none
// dropped.
bool numbers_are_indices(const scene::Scene& scene, const scene::Geometry& geometry) {
  const auto in_order = [](const auto& kept, const auto& number_of) {
    for (std::size_t i = 0; i < kept.size(); ++i)
      if (number_of(kept[i]) != i) return false;
    return true;
  };
  bool all = in_order(geometry.triangles, [](const auto& t) { return t.number; });
  primitives::for_each_shape([&](auto kind) {
    const auto& sources = decltype(kind)::of(scene);
    all = all &&
          in_order(decltype(kind)::of(geometry), [&](const auto& s) { return sources[s.source].number; });
  });
  return all;
}

Features geometry_features(const scene::Scene& scene, const scene::Geometry& geometry) {
  Features mask = when(!numbers_are_indices(scene, geometry), KDRAY_FEATURE_NUMBERS) |
                  when(geometry.n_smooth > geometry.zero_area.size(), KDRAY_FEATURE_SMOOTH) |
                  when(!geometry.zero_area.empty(), KDRAY_FEATURE_ZERO_AREA);
  primitives::for_each_kind([&](auto kind) {
    mask |= when(!decltype(kind)::of(geometry).empty(), KDRAY_FEATURE_OF_KIND(decltype(kind)::kNumber));
  });
  return mask;
}

bool in_footprints(const scene::Texturing& texturing, const scene::MaterialMaps& maps) {
  const auto used = {maps.base,          maps.normal_map,    maps.emission_map,
                     maps.occlusion_map, maps.highlight_map, maps.metal_map};
  return some(used, [&](std::uint32_t number) {
    if (number == scene::kNone) return false;
    const scene::Texture& texture = texturing.textures[number];
    return scene::needs_footprints(texture, *texturing.pictures[texture.picture]);
  });
}

Features features_of_maps(const scene::Texturing& texturing, const scene::MaterialMaps& written) {
  const scene::MaterialMaps maps = scene::largest_terms(written);
  const bool lit = maps.emission_map != scene::kNone || maps.occlusion_map != scene::kNone ||
                   maps.highlight_map != scene::kNone;
  const Features of_maps = when(maps.metal_map != scene::kNone, KDRAY_FEATURE_METAL_MAPS) |
                           when(maps.normal_map != scene::kNone, KDRAY_FEATURE_NORMAL_MAPS) |
                           when(lit, KDRAY_FEATURE_LIGHT_MAPS);
  return KDRAY_FEATURE_MATERIAL_MAPS | of_maps | when(maps.colored != 0, KDRAY_FEATURE_CORNER_COLORS) |
         when(of_maps != 0 || maps.base != scene::kNone, KDRAY_FEATURE_TEXTURES) |
         when(in_footprints(texturing, maps), KDRAY_FEATURE_FOOTPRINTS) |
         when(maps.mode == scene::Alpha::mask, KDRAY_FEATURE_CUTOUTS) |
         when(any(maps.reflect), KDRAY_FEATURE_REFLECT) |
         when(any(maps.transmit) || maps.mode == scene::Alpha::blend, KDRAY_FEATURE_TRANSMIT) |
         when(any(maps.specular), KDRAY_FEATURE_SPECULAR) | when(any(maps.diffuse), KDRAY_FEATURE_DIFFUSE);
}

// A material counts only when a primitive has it. `scene` has the materials, `part` the geometry's shapes.
std::vector<bool> materials_worn(const scene::Scene& scene, const scene::Scene& part,
                                 const scene::Geometry& geometry) {
  std::vector<bool> used(scene.materials.size(), false);
  for (const auto& t : geometry.triangles) used[t.material] = true;
  primitives::for_each_shape([&](auto kind) {
    for (const auto& s : decltype(kind)::of(geometry))
      used[decltype(kind)::of(part)[s.source].material] = true;
  });
  return used;
}

Features material_features(const scene::Scene& scene, const std::vector<bool>& used) {
  Features mask = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    const scene::Material& m = scene.materials[i];
    mask |= when(any(m.reflect), KDRAY_FEATURE_REFLECT) | when(any(m.transmit), KDRAY_FEATURE_TRANSMIT) |
            when(any(m.specular), KDRAY_FEATURE_SPECULAR) | when(any(m.diffuse), KDRAY_FEATURE_DIFFUSE);
    if (m.maps != scene::kNone)
      mask |= features_of_maps(scene.texturing, scene.texturing.material_maps[m.maps]);
  }
  return mask;
}

bool attenuated(const scene::Light& l) {
  return l.attenuation != dvec3(1, 0, 0) || std::isfinite(l.range);
}

Features features_of_floor(const scene::Floor& floor) {
  if (!(floor.radius > 0)) return 0;
  return KDRAY_FEATURE_FLOOR | KDRAY_FEATURE_DIFFUSE | when(floor.reflect > 0, KDRAY_FEATURE_REFLECT);
}

}  // namespace

Features features_of(const scene::Scene& scene, const scene::Geometry& geometry) {
  return features_in_light(
      geometry_features(scene, geometry) | material_features(scene, materials_worn(scene, scene, geometry)),
      scene);
}

Features features_of_mesh(const scene::Scene& scene, const scene::Scene& mesh,
                          const scene::Geometry& geometry) {
  return features_in_light(
      geometry_features(mesh, geometry) | material_features(scene, materials_worn(scene, mesh, geometry)),
      scene);
}

// Numbers are needed, since they count within a mesh, whose primitives lie behind others'.
Features features_of_instances(const scene::Scene& scene) {
  std::vector<bool> used(scene.materials.size(), false);
  for (const scene::Instance& instance : scene.instances)
    if (instance.material != scene::kNone) used[instance.material] = true;
  return features_in_light(KDRAY_FEATURE_INSTANCES | KDRAY_FEATURE_NUMBERS | material_features(scene, used),
                           scene);
}

Features features_in_light(Features mask, const scene::Scene& scene) {
  constexpr Features kOfLight = KDRAY_FEATURE_BACKGROUND | KDRAY_FEATURE_LIGHTS | KDRAY_FEATURE_ATTENUATION |
                                KDRAY_FEATURE_DIRECTIONAL | KDRAY_FEATURE_SPOT | KDRAY_FEATURE_SKY |
                                KDRAY_FEATURE_AREA_LIGHTS | KDRAY_FEATURE_LENS | KDRAY_FEATURE_FLOOR;
  const bool sky = scene.sky.kind != scene::SkyKind::none;
  mask = (mask & ~kOfLight) | when(sky || any(scene.background), KDRAY_FEATURE_BACKGROUND) |
         when(sky, KDRAY_FEATURE_SKY) | features_of_floor(scene.framing.floor) |
         when(scene.camera && scene.camera->aperture > 0, KDRAY_FEATURE_LENS);
  if (!(mask & (KDRAY_FEATURE_DIFFUSE | KDRAY_FEATURE_SPECULAR)))
    return mask;  // nothing that light could change
  for (const scene::Light& light : scene.lights)
    mask |= KDRAY_FEATURE_LIGHTS | when(attenuated(light), KDRAY_FEATURE_ATTENUATION) |
            when(light.kind == scene::LightKind::directional, KDRAY_FEATURE_DIRECTIONAL) |
            when(light.kind == scene::LightKind::spot, KDRAY_FEATURE_SPOT) |
            when(scene::has_area(light.kind), KDRAY_FEATURE_AREA_LIGHTS);
  return mask;
}

Features features_of_samples(int samples, bool adaptive) {
  return when(samples > 1, KDRAY_FEATURE_SUPERSAMPLE) | when(adaptive, KDRAY_FEATURE_ADAPTIVE);
}

std::span<const Feature> features() {
  return kFeatures;
}

FeatureNames feature_names(Features mask) {
  FeatureNames names;
  for (const Feature& f : kFeatures) (mask & f.bit ? names.on : names.off).push_back(f.name);
  return names;
}

}  // namespace kdray::flatten
