#include "scene/obj_materials.h"

#include <algorithm>
#include <map>
#include <system_error>

#include "base/error.h"
#include "scene/files_read.h"
#include "scene/mesh_material.h"
#include "scene/picture.h"
#include "scene/read_file.h"
#include "scene/text_scanner.h"
#include "scene/whitted_from_mtl.h"

namespace kdray::scene {

namespace {

constexpr std::size_t kLargestMtl = std::size_t{1} << 28;

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

// File names, separated by white space; a backslash before a space makes it part of the name.
std::vector<std::string> split(std::string_view names) {
  std::vector<std::string> out(1);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool joins = names[i] == '\\' && i + 1 < names.size() && names[i + 1] == ' ';
    if (joins) {
      out.back() += names[++i];
    } else if (names[i] != ' ' && names[i] != '\t') {
      out.back() += names[i];
    } else if (!out.back().empty()) {
      out.emplace_back();
    }
  }
  if (out.back().empty()) out.pop_back();
  return out;
}

std::string slashed(std::string path) {
  std::ranges::replace(path, '\\', '/');
  return path;
}

}  // namespace

// A name as it is given, beside the OBJ file or below.
std::filesystem::path ObjMaterials::find(const std::string& name) const {
  if (name.empty() || std::filesystem::path(name).is_absolute()) return "";
  const std::filesystem::path path = file_.parent_path() / name;
  if (is_file(path)) return path;
  FilesRead::add_missing(path);
  return "";
}

// The last part of a path: exporters write the paths of their own machine.
std::filesystem::path ObjMaterials::find_last_part(const std::string& name) const {
  return find(std::filesystem::path(name).filename().string());
}

bool ObjMaterials::read_library(const std::filesystem::path& path) {
  if (path.empty()) return false;
  if (std::ranges::find(read_files_, path) != read_files_.end()) return true;
  read_files_.push_back(path);
  read_mtl(read_file(path, kLargestMtl), path.string(), library_, scene_.warnings);
  return true;
}

// The text is one name, perhaps with spaces in it, or several names.
void ObjMaterials::add_library(std::string_view text, std::uint32_t line) {
  std::string names(text);
  std::ranges::replace(names, '\0', '?');
  if (read_library(find(slashed(names)))) return;
  std::string missing;
  bool any = false;
  for (const std::string& name : split(names)) {
    const bool found = read_library(find(slashed(name))) || read_library(find_last_part(slashed(name)));
    any = any || found;
    if (!found) missing.append(missing.empty() ? "" : " ").append(printable(name));
  }
  if (missing.empty() || (!any && read_library(find_last_part(slashed(names))))) return;
  scene_.warnings.push_back(file_.string() + ":" + std::to_string(line) + ": no material file '" + missing +
                            "'; faces whose materials are not found are grey");
}

void ObjMaterials::use(std::string_view name) {
  const auto [it, added] = numbers_.try_emplace(std::string(name), static_cast<std::uint32_t>(names_.size()));
  if (added) names_.emplace_back(name);
  current_ = it->second;
}

std::uint32_t ObjMaterials::current() {
  if (current_ == kNone) use("");  // faces before the first usemtl
  return current_;
}

std::optional<std::uint32_t> ObjMaterials::picture_of(const std::string& name) {
  const auto [it, added] = pictures_.try_emplace(name);
  if (!added) return it->second;
  const std::string given = slashed(name);
  std::filesystem::path path = find(given);
  if (path.empty()) path = find_last_part(given);
  try {
    if (path.empty())
      throw input_error(file_.string(), 0, "no picture '" + printable(name) + "'", "put it beside the scene");
    it->second = scene_.paint.add(decode_picture(read_file(path), path.string(), scene_.warnings));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input) throw;
    scene_.warnings.push_back(std::string(error.what()) + " (the picture is left out)");
  }
  return it->second;
}

// In MTL, v goes upwards from the picture's lower edge; in textures downwards from the upper one, which
// 1 - v at corners amounts to.
std::optional<std::uint32_t> ObjMaterials::texture_of(const MtlPicture& map) {
  const auto picture = picture_of(map.file);
  if (!picture) return std::nullopt;
  const auto f = [](double v) { return static_cast<float>(v); };
  const Wrap wrap = map.clamp ? Wrap::clamp : Wrap::repeat;
  return scene_.paint.add(Texture{.picture = *picture,
                                  .across = {f(map.scale[0]), 0, f(map.offset[0])},
                                  .down = {0, f(map.scale[1]), f(1 - map.scale[1] - map.offset[1])},
                                  .wrap_across = wrap,
                                  .wrap_down = wrap});
}

Material ObjMaterials::material_of(const MtlMaterial* mtl, bool colored) {
  std::optional<std::uint32_t> texture;
  if (mtl && mtl->map_kd) texture = texture_of(*mtl->map_kd);
  Coat coat;
  Material m;
  if (!mtl && colored) {
    m = colored_mesh_material(coat);
  } else {
    m = mtl ? whitted_from_mtl(*mtl, texture.has_value()) : mesh_material();
    if (!texture && !colored) return m;
    coat = {.ambient = m.ambient, .diffuse = m.diffuse, .colored = colored};
    if (texture) coat.base = *texture;
    m.ambient = m.diffuse = vec3(0);
  }
  m.coat = scene_.paint.add(coat);
  return m;
}

void ObjMaterials::finish(bool colored) {
  std::unordered_map<std::string_view, const MtlMaterial*> library;  // of several with one name, the first
  for (const MtlMaterial& m : library_) library.try_emplace(m.name, &m);
  std::size_t n_missing = 0;
  std::string first_missing;
  std::map<std::string, std::size_t> left_out;  // materials, by the statement
  for (const std::string& name : names_) {
    const auto found = library.find(name);
    const MtlMaterial* mtl = found == library.end() ? nullptr : found->second;
    scene_.materials.push_back(material_of(mtl, colored));
    if (mtl)
      for (const std::string& what : mtl->left_out) ++left_out[what];
    if (!mtl && !name.empty() && n_missing++ == 0) first_missing = name;
  }
  if (n_missing > 0 && !read_files_.empty()) {
    scene_.warnings.push_back(file_.string() + ": no material '" + printable(first_missing) + "'" +
                              (n_missing > 1 ? " and " + std::to_string(n_missing - 1) + " others" : "") +
                              " in its MTL files: grey instead");
  }
  for (const auto& [what, n] : left_out)
    scene_.warnings.push_back(file_.string() + ": " + what + " of " + std::to_string(n) +
                              (n == 1 ? " material" : " materials") + " is left out");
}

}  // namespace kdray::scene
