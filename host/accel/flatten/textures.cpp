#include "accel/flatten/textures.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "base/error.h"
#include "base/paged.h"
#include "scene/primitives/shape_tools.h"

namespace kdray::flatten {

namespace {

// A chain with mipmaps serves textures without as well, since its first level is the picture.
bool serves(const Chain& chain, const scene::Texture& texture) {
  return chain.picture == texture.picture &&
         (!scene::has_mipmaps(texture.minify) || (chain.mipmaps && chain.curved == texture.curved));
}

std::size_t add_chain(std::vector<Chain>& chains, const scene::Texture& texture) {
  const auto found =
      std::find_if(chains.begin(), chains.end(), [&](const Chain& c) { return serves(c, texture); });
  if (found != chains.end()) return static_cast<std::size_t>(found - chains.begin());
  chains.push_back(
      {.picture = texture.picture, .curved = texture.curved, .mipmaps = scene::has_mipmaps(texture.minify)});
  return chains.size() - 1;
}

void set_levels(const scene::Picture& picture, Chain& chain) {
  const std::vector<scene::LevelSize> sizes = scene::level_sizes(picture.width, picture.height);
  chain.size = sizes.front();
  chain.n_levels = chain.mipmaps ? sizes.size() : 1;
  chain.n_texels = 0;
  for (std::size_t k = 0; k < chain.n_levels; ++k) chain.n_texels += sizes[k].texels();
}

}  // namespace

// Textures with mipmaps come first, so that others find their chains.
TexelPlan plan_texels(const scene::Texturing& texturing) {
  TexelPlan plan;
  plan.chain_of.resize(texturing.textures.size());
  for (const bool mipmaps : {true, false})
    for (std::size_t i = 0; i < texturing.textures.size(); ++i)
      if (scene::has_mipmaps(texturing.textures[i].minify) == mipmaps)
        plan.chain_of[i] = add_chain(plan.chains, texturing.textures[i]);
  plan.n_texels = KDRAY_TEXEL_CURVE;
  for (Chain& chain : plan.chains) {
    set_levels(*texturing.pictures[chain.picture], chain);
    chain.first = plan.n_texels;
    plan.n_texels += chain.n_texels;
  }
  if (plan.n_texels > std::numeric_limits<layout::u32>::max())
    throw Error(ErrorCode::input, "the scene's pictures have over 2^32 texels; make them smaller");
  return plan;
}

Array<layout::u32> pack_texels(const scene::Texturing& texturing, const TexelPlan& plan) {
  Array<layout::u32> texels = paged_array<layout::u32>(plan.n_texels);
  for (layout::u32 code = 0; code < KDRAY_TEXEL_CURVE; ++code)
    texels[code] = scene::linear_unit_of_srgb(code / 255.0);
  tbb::parallel_for(std::size_t{0}, plan.chains.size(), [&](std::size_t i) {
    const Chain& chain = plan.chains[i];
    scene::write_levels(*texturing.pictures[chain.picture], chain.curved, 0, chain.n_levels,
                        std::span(texels.data() + chain.first, chain.n_texels));
  });
  return texels;
}

namespace {

using primitives::set;

constexpr std::size_t kGrain = 8192;  // triangles that one task packs

// Returns how a texture is shown where it is made smaller; `alike`: whether one texel is shown where it is
// made larger.
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

// Packs what the maps say beside the base colour. Where ambient light is occluded, it is kept apart from what
// is unshadowed.
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

// Packs, for each triangle of the geometry, what its source has at its corners in each of `sets`.
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

namespace {

constexpr std::size_t kSkyGrain = std::size_t{1} << 16;

// Packs a base colour, and what each step between two stops adds to it.
Array<float> pack_gradient(const scene::Sky& sky) {
  const auto& stops = sky.stops;
  Array<float> out(3 + KDRAY_SKY_STEP * (stops.size() - 1));
  const auto put = [](float* to, const vec3& v) { to[0] = v.x, to[1] = v.y, to[2] = v.z; };
  put(out.data(), stops[0].color);
  for (std::size_t i = 1; i < stops.size(); ++i) {
    float* const step = out.data() + 3 + KDRAY_SKY_STEP * (i - 1);
    step[0] = static_cast<float>(stops[i - 1].height);
    step[1] = static_cast<float>(1 / (stops[i].height - stops[i - 1].height));
    put(step + 2, stops[i].color - stops[i - 1].color);
    step[5] = 0;
  }
  return out;
}

// The film cuts contributions at its own most, so that nothing is lost where colours are cut there.
Array<float> pack_picture(const scene::Sky& sky) {
  if (!sky.picture) throw Error(ErrorCode::internal, "the sky's picture has been let go of");
  const std::vector<float>& rgb = sky.picture->rgb;
  const auto strength = static_cast<float>(sky.strength);
  Array<float> out(rgb.size());
  tbb::parallel_for(std::size_t{0}, (rgb.size() + kSkyGrain - 1) / kSkyGrain, [&](std::size_t grain) {
    for (std::size_t i = grain * kSkyGrain; i < std::min(rgb.size(), (grain + 1) * kSkyGrain); ++i)
      out[i] = std::min(rgb[i] * strength, KDRAY_SKY_MOST);
  });
  return out;
}

}  // namespace

void pack_sky(const scene::Sky& sky, FlatScene& flat) {
  if (sky.kind == scene::SkyKind::none) return;
  const bool gradient = sky.kind == scene::SkyKind::gradient;
  const scene::SkyAxes axes = scene::axes_of(sky);
  layout::Sky out{};
  primitives::set(out.right, vec3(axes.right));
  primitives::set(out.up, vec3(axes.up));
  primitives::set(out.forward, vec3(axes.forward));
  out.kind = gradient ? KDRAY_SKY_GRADIENT : KDRAY_SKY_PICTURE;
  out.width = gradient ? static_cast<layout::u32>(sky.stops.size() - 1) : sky.picture->width;
  out.height = gradient ? 1 : sky.picture->height;
  flat.sky_colors = gradient ? pack_gradient(sky) : pack_picture(sky);
  flat.sky = Array<layout::Sky>(1);
  flat.sky[0] = out;
}

}  // namespace kdray::flatten
