#include "scene/model/added_geometry.h"

#include <fmt/format.h>

#include <cstdint>

#include "base/error.h"
#include "scene/import/files.h"
#include "scene/textures/picture.h"
#include "scene/textures/texturing.h"

namespace kdray::scene {

namespace {

[[noreturn]] void refuse_texture(const std::string& what) {
  throw Error(ErrorCode::input, what);
}

// Grey, grey with alpha, colours, colours with alpha.
void spread(const std::uint8_t* from, std::uint32_t channels, std::uint8_t* to) {
  const bool grey = channels <= 2;
  for (std::uint32_t c = 0; c < 3; ++c) to[c] = from[grey ? 0 : c];
  to[3] = channels % 2 == 0 ? from[channels - 1] : std::uint8_t{255};
}

std::uint32_t texture_of(PictureId id, const char* name, bool curved, Texturing& texturing) {
  if (id == kNoPicture) return kNone;
  if (id >= texturing.pictures.size())
    throw Error(ErrorCode::usage, fmt::format("material: {}: there is no such picture; add it first", name));
  return texturing.add(Texture{.picture = id, .minify = Minify::linear_mipmap_linear, .curved = curved});
}

}  // namespace

std::shared_ptr<const Picture> picture_of(const Pixels& pixels) {
  const auto& [data, width, height, channels, row_bytes] = pixels;
  if (channels < 1 || channels > 4)
    refuse_texture(fmt::format("picture: {} channels; it may have 1 to 4", channels));
  if (width == 0 || height == 0) refuse_texture("picture: it has no pixels");
  if (width > kLongestSide || height > kLongestSide || std::size_t{width} * height > kMostTexels)
    refuse_texture(fmt::format("picture: {}x{} pixels; textures have {} at most, and no side over {}", width,
                               height, kMostTexels, kLongestSide));
  if (data == nullptr) refuse_texture("picture: no data");
  const std::size_t pixels_of_row = std::size_t{width} * channels;
  const std::size_t row = row_bytes == 0 ? pixels_of_row : row_bytes;
  if (row < pixels_of_row)
    refuse_texture(fmt::format("picture: its rows of {} bytes are {} bytes apart", pixels_of_row, row));
  if (height > 1 && row > static_cast<std::size_t>(PTRDIFF_MAX) / height)
    refuse_texture(fmt::format("picture: {} rows, {} bytes apart, reach beyond any memory", height, row));
  Picture picture = blank_picture("a picture", width, height);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      spread(data + y * row + std::size_t{x} * channels, channels,
             picture.texels.data() + 4 * (std::size_t{y} * width + x));
  return std::make_shared<const Picture>(std::move(picture));
}

std::shared_ptr<const Picture> picture_of(const std::filesystem::path& file,
                                          std::vector<std::string>& warnings) {
  return decode_picture(read_file(file), file.string(), warnings);
}

Material textured_material(const kdray::Material& material, Texturing& texturing) {
  const Material terms = material_of(material);
  MaterialMaps maps{.base = texture_of(material.picture, "picture", true, texturing)};
  maps.normal_map = texture_of(material.normal_picture, "normal_picture", false, texturing);
  maps.emission_map = texture_of(material.emission_picture, "emission_picture", true, texturing);
  maps.metal_map = texture_of(material.metal_picture, "metal_picture", false, texturing);
  maps.occlusion_map = texture_of(material.occlusion_picture, "occlusion_picture", false, texturing);
  static_assert(static_cast<int>(AlphaMode::blend) == static_cast<int>(Alpha::blend));
  if (material.alpha < AlphaMode::opaque || material.alpha > AlphaMode::blend)
    refuse_texture("material: there is no such mode of alpha");
  if (material.alpha != AlphaMode::opaque && maps.base == kNone)
    refuse_texture("material: there is no picture whose alpha is to be used");
  maps.mode = static_cast<Alpha>(material.alpha);
  maps.metal = {.base = terms.diffuse, .metallic = material.metallic, .roughness = material.roughness};
  maps.occlusion = material.occlusion;
  if (const char* const fault = fault_of_factors(maps)) refuse_texture(fmt::format("material: {}", fault));
  if (maps.emission_map != kNone) maps.emissive = terms.emission == vec3(0) ? vec3(1) : terms.emission;
  return with_pictures(terms, maps, texturing);
}

void assemble_textures(Scene& scene, std::span<const AddedGeometry* const> geometries,
                       const Texturing& texturing, std::size_t n_materials) {
  if (texturing.material_maps.empty()) return;
  const std::vector<std::uint32_t> numbers = scene.texturing.append(texturing, scene.triangles.size(), 0);
  for (std::size_t i = scene.materials.size() - n_materials; i < scene.materials.size(); ++i)
    if (scene.materials[i].maps != kNone) scene.materials[i].maps = numbers[scene.materials[i].maps];
  std::size_t first = scene.triangles.size();
  for (const AddedGeometry* const g : geometries) first -= g->triangles.size();
  auto& all = scene.texturing.texcoords[0];
  for (const AddedGeometry* const g : geometries) {
    if (!g->texcoords.empty()) {
      all.resize(first);
      all.insert(all.end(), g->texcoords.begin(), g->texcoords.end());
    }
    first += g->triangles.size();
  }
}

}  // namespace kdray::scene
