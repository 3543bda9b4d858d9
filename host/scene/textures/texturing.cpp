#include "scene/textures/texturing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/paged.h"
#include "scene/model/scene.h"

namespace kdray::scene {

namespace {

template <class T>
std::uint32_t place_in(std::vector<T>& all, const T& one) {
  const auto found = std::find(all.begin(), all.end(), one);
  if (found != all.end()) return static_cast<std::uint32_t>(found - all.begin());
  all.push_back(one);
  return static_cast<std::uint32_t>(all.size() - 1);
}

// Appends, with `empty` for the triangles before, and for those of a part that has no entries.
template <class T>
void append_corners(PageVector<T>& to, const PageVector<T>& from, std::size_t before, std::size_t n_triangles,
                    const T& empty) {
  if (from.empty()) return;
  to.resize(before, empty);
  to.insert(to.end(), from.begin(), from.end());
  to.resize(before + n_triangles, empty);
}

}  // namespace

std::uint32_t Texturing::add(const std::shared_ptr<const Picture>& picture) {
  return place_in(pictures, picture);
}
std::uint32_t Texturing::add(const Texture& texture) {
  return place_in(textures, texture);
}
std::uint32_t Texturing::add(const MaterialMaps& maps) {
  return place_in(material_maps, maps);
}

std::vector<std::uint32_t> Texturing::append(const Texturing& part, std::size_t before,
                                             std::size_t n_triangles) {
  append_corners(colors, part.colors, before, n_triangles, kWhiteCorners);
  for (std::size_t set = 0; set < texcoords.size(); ++set)
    append_corners(texcoords[set], part.texcoords[set], before, n_triangles, layout::TexCoords{});
  append_corners(tangents, part.tangents, before, n_triangles, layout::TexCoords{});
  std::vector<std::uint32_t> numbers;
  for (MaterialMaps maps : part.material_maps) {
    for (std::uint32_t* const map : {&maps.base, &maps.normal_map, &maps.emission_map, &maps.occlusion_map,
                                     &maps.highlight_map, &maps.metal_map}) {
      if (*map >= part.textures.size()) continue;
      Texture texture = part.textures[*map];
      texture.picture = add(part.pictures[texture.picture]);
      *map = add(texture);
    }
    numbers.push_back(add(maps));
  }
  return numbers;
}

MaterialMaps largest_terms(const MaterialMaps& maps) {
  MaterialMaps out = maps;
  out.emission += maps.emissive;
  if (maps.metal_map == 0xffffffffu) return out;
  const Metal& m = maps.metal;
  out.diffuse = m.base;
  out.ambient = KDRAY_METAL_AMBIENT * m.base;
  out.specular = KDRAY_METAL_HIGHLIGHT + m.base;
  out.reflect = std::min(m.metallic, 1.0f) * m.base + m.transmission * m.mirrored;
  out.transmit = m.transmission * m.base;
  return out;
}

bool needs_footprints(const Texture& texture, const Picture& picture) {
  if (picture.width == 1 && picture.height == 1) return false;
  const Minify same = texture.nearest ? Minify::nearest : Minify::linear;
  return texture.minify != Minify::as_magnified && texture.minify != same;
}

std::uint32_t linear_unit(double value) {
  if (!(value > 0)) return 0;
  return static_cast<std::uint32_t>(std::lround(std::min(value, 1.0) * 65535));
}

Picture blank_picture(const std::string& name, std::uint32_t width, std::uint32_t height) {
  return {name, width, height, paged_array<std::uint8_t>(std::size_t{4} * width * height)};
}

// Source: IEC 61966-2-1.
std::uint32_t linear_unit_of_srgb(double code) {
  const double c = std::clamp(code, 0.0, 1.0);
  return linear_unit(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

void set_corner(layout::CornerColors& colors, std::size_t corner, const std::array<std::uint32_t, 4>& rgba) {
  colors.c[corner][0] = rgba[0] | rgba[1] << 16;
  colors.c[corner][1] = rgba[2] | rgba[3] << 16;
}

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
