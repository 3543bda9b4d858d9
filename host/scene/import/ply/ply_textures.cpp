#include "scene/import/ply/ply_textures.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "base/error.h"
#include "scene/import/find_file.h"
#include "scene/import/mesh_material.h"
#include "scene/import/read_file.h"
#include "scene/import/text_scanner.h"
#include "scene/textures/picture.h"

namespace kdray::scene::ply {

namespace {

// By its name, or its last part beside the scene: programs write the paths of their own machine.
std::filesystem::path find_picture(const std::string& name, const std::filesystem::path& folder) {
  const std::filesystem::path path = std::filesystem::path(slashed(name)).lexically_normal();
  std::filesystem::path found;
  if (may_name(folder, path)) found = find_file(folder / path);
  return found.empty() && path.has_filename() ? find_file(folder / path.filename()) : found;
}

std::optional<std::uint32_t> picture_of(Scene& scene, const std::string& name, const std::string& file) {
  const std::filesystem::path path = find_picture(name, std::filesystem::path(file).parent_path());
  try {
    if (path.empty())
      throw input_error(file, 0, "no picture '" + printable(name) + "'",
                        std::string("put it beside the scene; ") + kAllowAFolder);
    return scene.texturing.add(decode_picture(read_file(path), path.string(), scene.warnings));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input) throw;
    scene.warnings.push_back(std::string(error.what()) + " (the picture is left out)");
    return std::nullopt;
  }
}

// The same as without a picture, which the base colour is looked up in.
Material textured(Scene& scene, std::uint32_t picture) {
  MaterialMaps maps;
  Material m = colored_mesh_material(maps);
  maps.base = scene.texturing.add(Texture{.picture = picture, .minify = Minify::linear_mipmap_linear});
  maps.colored = !scene.texturing.colors.empty();
  m.maps = scene.texturing.add(maps);
  return m;
}

}  // namespace

void lay_on_textures(Scene& scene, const Header& header, const std::string& file) {
  if (header.textures.empty()) return;
  const bool numbered =
      std::ranges::any_of(scene.triangles, [](const Triangle& t) { return t.material > 0; });
  const std::size_t n = numbered ? header.textures.size() : 1;
  if (header.textures.size() > n)
    scene.warnings.push_back(file + ": " + std::to_string(header.textures.size() - n) +
                             " further pictures are left out: no face has their texnumber");
  if (scene.texturing.texcoords[0].empty()) {
    scene.warnings.push_back(file + ": its picture '" + printable(header.textures[0]) +
                             "' is left out: there are no texture coordinates");
    for (Triangle& t : scene.triangles) t.material = 0;
    return;
  }
  const Material plain = scene.materials[0];
  scene.materials.assign(n, plain);
  for (std::size_t i = 0; i < n; ++i)
    if (const auto picture = picture_of(scene, header.textures[i], file))
      scene.materials[i] = textured(scene, *picture);
}

}  // namespace kdray::scene::ply
