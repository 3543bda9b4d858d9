#include "accel/flatten/textures.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "accel/flatten/texels.h"
#include "scene/primitives/pack.h"

namespace kdray::flatten {

namespace {

using primitives::set;

constexpr std::size_t kGrain = 8192;  // triangles that one task packs

// Where it is shown smaller; `alike`: one texel where it is shown larger.
layout::u32 how_minified(scene::Minify minify, bool alike) {
  using scene::Minify;
  const bool one = minify == Minify::as_magnified
                       ? alike
                       : minify == Minify::nearest || minify == Minify::nearest_mipmap_nearest ||
                             minify == Minify::nearest_mipmap_linear;
  const bool two_levels = minify == Minify::nearest_mipmap_linear || minify == Minify::linear_mipmap_linear;
  return (one ? KDRAY_TEXTURE_MIN_NEAREST : 0u) | (scene::has_mipmaps(minify) ? KDRAY_TEXTURE_MIPMAPS : 0u) |
         (two_levels ? KDRAY_TEXTURE_MIP_LINEAR : 0u);
}

// What triangles have at their corners beside the first set of coordinates.
struct Sets {
  bool second, tangents;
};

layout::u32 how_of(const scene::Texture& t, const Sets& sets) {
  return static_cast<layout::u32>(t.wrap_across) | static_cast<layout::u32>(t.wrap_down) << 2 |
         (t.nearest ? KDRAY_TEXTURE_NEAREST : 0u) | (t.curved ? KDRAY_TEXTURE_CURVED : 0u) | t.set << 6 |
         (sets.second ? 1u << 7 : 0u) | (sets.tangents ? KDRAY_TEXTURE_TANGENTS : 0u) |
         how_minified(t.minify, t.nearest);
}

layout::u32 how_of(const scene::MaterialMaps& c) {
  return (c.colored ? KDRAY_MAPS_COLORED : 0u) | (c.mode == scene::Alpha::mask ? KDRAY_MAPS_MASK : 0u) |
         (c.mode == scene::Alpha::blend ? KDRAY_MAPS_BLEND : 0u) |
         (c.metal_map != scene::kNone ? KDRAY_MAPS_METAL : 0u) | (c.tangents ? KDRAY_MAPS_TANGENTS : 0u);
}

// What the maps say beside the base colour. Where ambient light is occluded, it is kept apart from
// what is unshadowed.
void pack_maps(const scene::MaterialMaps& c, const vec3& ambient_light, layout::MaterialMaps& out) {
  static_assert(scene::kNone == KDRAY_NO_TEXTURE);
  out.normal_map = c.normal_map;
  out.emission_map = c.emission_map;
  out.occlusion_map = c.occlusion_map;
  out.highlight_map = c.highlight_map;
  out.metal_map = c.metal_map;
  out.normal_scale = c.normal_scale;
  out.occlusion = c.occlusion;
  set(out.emissive, c.emissive);
  const bool metal = c.metal_map != scene::kNone;
  if (metal) {
    set(out.ambient, KDRAY_METAL_AMBIENT * ambient_light);
  } else if (c.occlusion_map != scene::kNone) {
    set(out.unshadowed, c.emission);
    set(out.ambient, c.ambient * ambient_light);
  }
  out.metallic = c.metal.metallic;
  out.roughness = c.metal.roughness;
  out.transmission = c.metal.transmission;
  out.mirrored = c.metal.mirrored;
  set(out.base_color, c.metal.base);
}

layout::MaterialMaps pack(const scene::MaterialMaps& c, const vec3& ambient_light) {
  layout::MaterialMaps out{};
  set(out.unshadowed, c.emission + c.ambient * ambient_light);
  set(out.diffuse, c.diffuse);
  set(out.specular, c.specular);
  set(out.reflect, c.reflect);
  set(out.transmit, c.transmit);
  out.alpha = c.alpha;
  out.cutoff = c.cutoff;
  out.base = c.base;
  out.how = how_of(c);
  pack_maps(c, ambient_light, out);
  return out;
}

Array<layout::Texture> pack_textures(const scene::Texturing& texturing, const TexelPlan& plan,
                                     const Sets& sets) {
  Array<layout::Texture> textures(texturing.textures.size());
  for (std::size_t i = 0; i < textures.size(); ++i) {
    const scene::Texture& from = texturing.textures[i];
    const Chain& chain = plan.chains[plan.chain_of[i]];
    layout::Texture t{};
    std::copy(from.across.begin(), from.across.end(), t.across);
    std::copy(from.down.begin(), from.down.end(), t.down);
    t.first = static_cast<layout::u32>(chain.first);
    t.width = chain.size.width;
    t.height = chain.size.height;
    t.how = how_of(from, sets);
    t.n_levels = static_cast<layout::u32>(chain.n_levels);
    textures[i] = t;
  }
  return textures;
}

// For each triangle of the geometry those that its source has in each of `sets`.
template <class T>
Array<T> pack_corners(const scene::Geometry& geometry, const std::vector<const PageVector<T>*>& sets,
                      const T& none) {
  const std::size_t n = geometry.triangles.size(), each = sets.size();
  Array<T> out(n * each);
  if (each == 0) return out;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, kGrain), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      for (std::size_t k = 0; k < each; ++k) {
        const std::size_t source = geometry.sources[i];
        out[i * each + k] = source < sets[k]->size() ? (*sets[k])[source] : none;
      }
  });
  return out;
}

Sets sets_of(const scene::Texturing& texturing) {
  return {std::ranges::any_of(texturing.textures, [](const scene::Texture& t) { return t.set == 1; }),
          std::ranges::any_of(texturing.material_maps,
                              [](const scene::MaterialMaps& c) { return c.tangents != 0; })};
}

}  // namespace

Array<layout::MaterialMaps> pack_material_maps(const scene::Scene& scene) {
  Array<layout::MaterialMaps> material_maps(scene.texturing.material_maps.size());
  for (std::size_t i = 0; i < material_maps.size(); ++i)
    material_maps[i] = pack(scene.texturing.material_maps[i], scene.ambient);
  return material_maps;
}

void pack_textures_of(const scene::Scene& scene, const scene::Geometry& geometry, FlatScene& flat) {
  const scene::Texturing& texturing = scene.texturing;
  if (texturing.material_maps.empty()) return;
  flat.material_maps = pack_material_maps(scene);
  if (!texturing.textures.empty()) {
    const TexelPlan plan = plan_texels(texturing);
    flat.texels = pack_texels(texturing, plan);
    flat.textures = pack_textures(texturing, plan, sets_of(texturing));
  }
  pack_corners_of(texturing, scene, geometry, flat);
}

void pack_corners_of(const scene::Texturing& texturing, const scene::Scene& mesh,
                     const scene::Geometry& geometry, FlatScene& flat) {
  const scene::Texturing& own = mesh.texturing;
  if (!texturing.textures.empty()) {
    std::vector<const PageVector<layout::TexCoords>*> sets{&own.texcoords[0]};
    const Sets has = sets_of(texturing);
    if (has.second) sets.push_back(&own.texcoords[1]);
    if (has.tangents) sets.push_back(&own.tangents);
    flat.texcoords = pack_corners(geometry, sets, layout::TexCoords{});
  }
  const bool colored = std::any_of(texturing.material_maps.begin(), texturing.material_maps.end(),
                                   [](const scene::MaterialMaps& c) { return c.colored != 0; });
  if (colored) flat.corner_colors = pack_corners(geometry, {&own.colors}, scene::kWhiteCorners);
}

}  // namespace kdray::flatten
