#include "scene/textures/picture_coat.h"

#include <algorithm>
#include <array>

namespace kdray::scene {

Material with_pictures(const Material& terms, const Coat& maps, Paint& paint) {
  const bool shows = std::ranges::any_of(
      std::array{maps.base, maps.normal_map, maps.emission_map, maps.occlusion_map, maps.metal_map},
      [](std::uint32_t map) { return map != kNone; });
  if (!shows) return terms;
  Material m = terms;
  Coat coat = maps;
  if (coat.metal_map != kNone) {
    m = {.emission = terms.emission};
  } else if (coat.base != kNone) {
    coat.ambient = m.ambient, coat.diffuse = m.diffuse, coat.transmit = m.transmit;
    m.ambient = m.diffuse = m.transmit = vec3(0);
  } else if (coat.occlusion_map != kNone) {
    coat.ambient = m.ambient;
    m.ambient = vec3(0);
  }
  if (coat.emission_map != kNone) m.emission = vec3(0);
  m.coat = paint.add(coat);
  return m;
}

const char* fault_of_factors(const Coat& maps) {
  const auto share = [](float v) { return v >= 0 && v <= 1; };
  if (!share(maps.metal.metallic)) return "metallic may be 0 to 1";
  if (!share(maps.metal.roughness)) return "roughness may be 0 to 1";
  if (!share(maps.occlusion)) return "occlusion may be 0 to 1";
  return nullptr;
}

}  // namespace kdray::scene
