#include "flatten/paint.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <vector>

#include "base/error.h"
#include "primitives/pack.h"

namespace kdray::flatten {

namespace {

using primitives::set;

constexpr std::size_t kGrain = 8192;  // triangles that one task packs

layout::u32 how_of(const scene::Texture& t, bool two_sets) {
  return static_cast<layout::u32>(t.wrap_across) | static_cast<layout::u32>(t.wrap_down) << 2 |
         (t.nearest ? KDRAY_TEXTURE_NEAREST : 0u) | (t.curved ? KDRAY_TEXTURE_CURVED : 0u) | t.set << 6 |
         (two_sets ? 1u << 7 : 0u);
}

layout::u32 how_of(const scene::Coat& c) {
  return (c.colored ? KDRAY_COAT_COLORED : 0u) | (c.mode == scene::Alpha::mask ? KDRAY_COAT_MASK : 0u) |
         (c.mode == scene::Alpha::blend ? KDRAY_COAT_BLEND : 0u);
}

layout::Coat pack(const scene::Coat& c, const vec3& ambient_light) {
  layout::Coat out{};
  set(out.unshadowed, c.emission + c.ambient * ambient_light);
  set(out.diffuse, c.diffuse);
  set(out.specular, c.specular);
  set(out.reflect, c.reflect);
  set(out.transmit, c.transmit);
  out.alpha = c.alpha;
  out.cutoff = c.cutoff;
  out.base = c.base == scene::kNone ? KDRAY_NO_TEXTURE : c.base;
  out.how = how_of(c);
  return out;
}

// Where each picture's texels begin; the last entry is their end.
std::vector<std::size_t> places_of(const scene::Scene& scene) {
  std::vector<std::size_t> places{KDRAY_TEXEL_CURVE};
  for (const auto& picture : scene.paint.pictures)
    places.push_back(places.back() + std::size_t{picture->width} * picture->height);
  if (places.back() > std::numeric_limits<layout::u32>::max())
    throw Error(ErrorCode::input, "the scene's pictures have over 2^32 texels; make them smaller");
  return places;
}

Array<layout::u32> pack_texels(const scene::Scene& scene, const std::vector<std::size_t>& places) {
  Array<layout::u32> texels(places.back());
  for (layout::u32 code = 0; code < KDRAY_TEXEL_CURVE; ++code)
    texels[code] = scene::linear_unit_of_srgb(code / 255.0);
  tbb::parallel_for(std::size_t{0}, scene.paint.pictures.size(), [&](std::size_t i) {
    // Bytes in this order are words of a little-endian machine, as every one with an OpenCL device is.
    const auto& bytes = scene.paint.pictures[i]->texels;
    std::memcpy(texels.data() + places[i], bytes.data(), bytes.size());
  });
  return texels;
}

Array<layout::Texture> pack_textures(const scene::Scene& scene, const std::vector<std::size_t>& places,
                                     bool two_sets) {
  Array<layout::Texture> textures(scene.paint.textures.size());
  for (std::size_t i = 0; i < textures.size(); ++i) {
    const scene::Texture& from = scene.paint.textures[i];
    const scene::Picture& picture = *scene.paint.pictures[from.picture];
    layout::Texture t{};
    std::copy(from.across.begin(), from.across.end(), t.across);
    std::copy(from.down.begin(), from.down.end(), t.down);
    t.first = static_cast<layout::u32>(places[from.picture]);
    t.width = picture.width;
    t.height = picture.height;
    t.how = how_of(from, two_sets);
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

bool uses_second_set(const scene::Paint& paint) {
  return std::any_of(paint.textures.begin(), paint.textures.end(),
                     [](const scene::Texture& t) { return t.set == 1; });
}

}  // namespace

Array<layout::Coat> pack_coats(const scene::Scene& scene) {
  Array<layout::Coat> coats(scene.paint.coats.size());
  for (std::size_t i = 0; i < coats.size(); ++i) coats[i] = pack(scene.paint.coats[i], scene.ambient);
  return coats;
}

void pack_paint(const scene::Scene& scene, const scene::Geometry& geometry, FlatScene& flat) {
  const scene::Paint& paint = scene.paint;
  if (paint.coats.empty()) return;
  flat.coats = pack_coats(scene);
  if (!paint.textures.empty()) {
    const std::vector<std::size_t> places = places_of(scene);
    const bool two_sets = uses_second_set(paint);
    flat.texels = pack_texels(scene, places);
    flat.textures = pack_textures(scene, places, two_sets);
  }
  pack_corners_of(paint, scene, geometry, flat);
}

void pack_corners_of(const scene::Paint& paint, const scene::Scene& mesh, const scene::Geometry& geometry,
                     FlatScene& flat) {
  const scene::Paint& own = mesh.paint;
  if (!paint.textures.empty()) {
    std::vector<const PageVector<layout::TexCoords>*> sets{&own.texcoords[0]};
    if (uses_second_set(paint)) sets.push_back(&own.texcoords[1]);
    flat.texcoords = pack_corners(geometry, sets, layout::TexCoords{});
  }
  const bool colored = std::any_of(paint.coats.begin(), paint.coats.end(),
                                   [](const scene::Coat& c) { return c.colored != 0; });
  if (colored) flat.corner_colors = pack_corners(geometry, {&own.colors}, scene::kWhiteCorners);
}

}  // namespace kdray::flatten
