#include "scene/textures/mapped_material.h"

#include <algorithm>
#include <array>

namespace kdray::scene {

Material with_pictures(const Material& terms, const MaterialMaps& maps, Texturing& texturing) {
  const bool shows = std::ranges::any_of(
      std::array{maps.base, maps.normal_map, maps.emission_map, maps.occlusion_map, maps.metal_map},
      [](std::uint32_t map) { return map != kNone; });
  if (!shows) return terms;
  Material m = terms;
  MaterialMaps out = maps;
  if (out.metal_map != kNone) {
    m = {.emission = terms.emission};
  } else if (out.base != kNone) {
    out.ambient = m.ambient, out.diffuse = m.diffuse, out.transmit = m.transmit;
    m.ambient = m.diffuse = m.transmit = vec3(0);
  } else if (out.occlusion_map != kNone) {
    out.ambient = m.ambient;
    m.ambient = vec3(0);
  }
  if (out.emission_map != kNone) m.emission = vec3(0);
  m.maps = texturing.add(out);
  return m;
}

const char* fault_of_factors(const MaterialMaps& maps) {
  const auto share = [](float v) { return v >= 0 && v <= 1; };
  if (!share(maps.metal.metallic)) return "metallic may be 0 to 1";
  if (!share(maps.metal.roughness)) return "roughness may be 0 to 1";
  if (!share(maps.occlusion)) return "occlusion may be 0 to 1";
  return nullptr;
}

}  // namespace kdray::scene
