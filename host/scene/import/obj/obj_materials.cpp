#include "scene/import/obj/mtl.h"

#include <algorithm>
#include <map>

#include "base/error.h"
#include "scene/import/files.h"
#include "scene/import/materials.h"
#include "scene/import/text_scanner.h"
#include "scene/textures/picture.h"

namespace kdray::scene {

namespace {

constexpr std::size_t kLargestMtl = std::size_t{1} << 28;

// File names, separated by white space; a backslash before a space, or quotes around the name, make it part
// of the name.
std::vector<std::string> split(std::string_view names) {
  std::vector<std::string> out(1);
  bool quoted = false;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool joins = names[i] == '\\' && i + 1 < names.size() && names[i + 1] == ' ';
    if (joins) {
      out.back() += names[++i];
    } else if (names[i] == '"') {
      quoted = !quoted;
    } else if (quoted || (names[i] != ' ' && names[i] != '\t')) {
      out.back() += names[i];
    } else if (!out.back().empty()) {
      out.emplace_back();
    }
  }
  if (out.back().empty()) out.pop_back();
  return out;
}

// Black beside a picture is how exporters say that the picture alone counts.
vec3 factor_of_picture(const vec3& color) {
  return color == vec3(0) ? vec3(1) : color;
}

bool says_something(const MaterialMaps& c) {
  return c.base != kNone || c.emission_map != kNone || c.highlight_map != kNone || c.normal_map != kNone ||
         c.colored != 0;
}

// Finds materials by their names. A name that no material has stands for the only one that differs from it in
// capitals alone, if there is one.
class Library {
 public:
  explicit Library(const std::vector<MtlMaterial>& materials) {
    for (const MtlMaterial& m : materials) {
      const bool is_new = exact_.try_emplace(m.name, &m).second;  // of several with one name, the first
      const auto [alike, is_only] = alike_.try_emplace(lower(m.name), &m);
      if (is_new && !is_only) alike->second = nullptr;
    }
  }

  const MtlMaterial* find(const std::string& name) const {
    if (const auto found = exact_.find(name); found != exact_.end()) return found->second;
    const auto found = alike_.find(lower(name));
    return found == alike_.end() ? nullptr : found->second;
  }

 private:
  std::unordered_map<std::string_view, const MtlMaterial*> exact_;
  std::unordered_map<std::string, const MtlMaterial*> alike_;
};

// Exporters have written `Tr 1` and `d 0` for what is opaque.
bool all_are_invisible(const Library& library, const std::vector<std::string>& names) {
  bool any = false;
  for (const std::string& name : names) {
    const MtlMaterial* const mtl = library.find(name);
    if (mtl ? !is_invisible(*mtl) : name.empty()) return false;  // without a name it is the default one
    any = any || mtl;
  }
  return any;
}

}  // namespace

// Returns a name as it is given, or without its quotes, from the OBJ file's folder on.
std::filesystem::path ObjMaterials::find(const std::string& name) const {
  for (const std::string_view given : {std::string_view(name), unquoted(name)}) {
    const std::filesystem::path path(given), folder = file_.parent_path();
    if (path.empty() || (path.is_absolute() && !may_name(folder, path))) continue;
    if (const auto found = find_file(folder / path); !found.empty()) return found;
    if (given == unquoted(name)) break;
  }
  return "";
}

// Returns the last part of a path: exporters write the paths of their own machine.
std::filesystem::path ObjMaterials::find_last_part(const std::string& name) const {
  return find(std::filesystem::path(unquoted(name)).filename().string());
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
      throw input_error(file_.string(), 0, "no picture '" + printable(name) + "'",
                        std::string("put it beside the scene; ") + kAllowAFolder);
    it->second = scene_.texturing.add(decode_picture(read_file(path), path.string(), scene_.warnings));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input) throw;
    scene_.warnings.push_back(std::string(error.what()) + " (the picture is left out)");
  }
  return it->second;
}

// A relief's picture may show its normals instead of its heights: it isn't grey then.
std::optional<std::uint32_t> ObjMaterials::normals_of(const MtlMaterial& mtl) {
  if (mtl.normals) return texture_of(*mtl.normals, false);
  if (!mtl.relief) return std::nullopt;
  const auto picture = picture_of(mtl.relief->file);
  if (!picture) return std::nullopt;
  const Picture& shown = *scene_.texturing.pictures[*picture];
  if (!is_grey(shown)) return add_texture(*picture, *mtl.relief, false);
  const auto normals = normals_of_heights(shown, mtl.relief->strength);
  return add_texture(scene_.texturing.add(normals), *mtl.relief, false);
}

// The picture of `map_d` becomes the alpha of that of `map_Kd`, which is laid on as it is.
std::optional<std::uint32_t> ObjMaterials::veiled(const MtlMaterial& mtl, MaterialMaps& maps) {
  const auto base = mtl.map_kd ? picture_of(mtl.map_kd->file) : std::nullopt;
  const auto alpha = picture_of(mtl.map_d->file);
  if (!alpha) return mtl.map_kd ? texture_of(*mtl.map_kd, true) : std::nullopt;
  const MtlPicture& laid = base ? *mtl.map_kd : *mtl.map_d;
  if (laid.scale != mtl.map_d->scale || laid.offset != mtl.map_d->offset)
    scene_.warnings.push_back(file_.string() + ": map_d of '" + printable(mtl.name) +
                              "' is laid on as map_Kd is, whose options are others");
  const auto mixed =
      with_alpha(base ? scene_.texturing.pictures[*base].get() : nullptr, *scene_.texturing.pictures[*alpha]);
  maps.mode = is_cut_out(*mixed) ? Alpha::mask : Alpha::blend;
  return add_texture(scene_.texturing.add(mixed), laid, true);
}

// In MTL, v goes upwards from the picture's lower edge; in textures downwards from the upper one, which
// 1 - v at corners amounts to.
std::uint32_t ObjMaterials::add_texture(std::uint32_t picture, const MtlPicture& map, bool curved) {
  const auto f = [](double v) { return static_cast<float>(v); };
  const Wrap wrap = map.clamp ? Wrap::clamp : Wrap::repeat;
  return scene_.texturing.add(Texture{.picture = picture,
                                      .across = {f(map.scale[0]), 0, f(map.offset[0])},
                                      .down = {0, f(map.scale[1]), f(1 - map.scale[1] - map.offset[1])},
                                      .wrap_across = wrap,
                                      .wrap_down = wrap,
                                      .minify = Minify::linear_mipmap_linear,
                                      .curved = curved});
}

std::optional<std::uint32_t> ObjMaterials::texture_of(const MtlPicture& map, bool curved) {
  const auto picture = picture_of(map.file);
  return picture ? std::optional(add_texture(*picture, map, curved)) : std::nullopt;
}

// Emission, highlights and normals by pictures, which go over from the material into its maps.
void ObjMaterials::add_maps(const MtlMaterial& mtl, Material& m, MaterialMaps& maps) {
  if (const auto map = mtl.map_ke ? texture_of(*mtl.map_ke, true) : std::nullopt) {
    maps.emission_map = *map;
    maps.emissive = factor_of_picture(mtl.ke);
    m.emission = vec3(0);
  }
  if (const auto map = mtl.map_ks ? texture_of(*mtl.map_ks, true) : std::nullopt) {
    maps.highlight_map = *map;
    maps.specular = m.specular;
    maps.reflect = m.reflect;
    m.specular = m.reflect = vec3(0);
  }
  if (const auto map = normals_of(mtl)) maps.normal_map = *map;
}

Material ObjMaterials::material_of(const MtlMaterial* mtl, bool colored) {
  MaterialMaps maps;
  Material m;
  if (!mtl && !colored) return mesh_material();
  if (!mtl) {
    m = colored_mesh_material(maps);
  } else {
    std::optional<std::uint32_t> texture;
    if (mtl->map_d) {
      texture = veiled(*mtl, maps);
    } else if (mtl->map_kd) {
      texture = texture_of(*mtl->map_kd, true);
    }
    m = whitted_from_mtl(*mtl, texture.has_value());
    if (texture) maps.base = *texture;
    maps.colored = colored;
    add_maps(*mtl, m, maps);
    if (!says_something(maps)) return m;
    maps.ambient = m.ambient, maps.diffuse = m.diffuse;
    m.ambient = m.diffuse = vec3(0);
  }
  m.maps = scene_.texturing.add(maps);
  return m;
}

void ObjMaterials::finish(bool colored, NameTable& names) {
  const Library library(library_);
  std::size_t n_missing = 0;
  std::string first_missing;
  std::map<std::string, std::size_t> left_out;  // materials, by the statement
  const bool opaque = all_are_invisible(library, names_);
  if (opaque)
    scene_.warnings.push_back(file_.string() +
                              ": by d or Tr of its MTL file nothing of it is seen: it is opaque instead");
  for (const std::string& name : names_) {
    const MtlMaterial* mtl = library.find(name);
    MtlMaterial seen;
    if (mtl && opaque) seen = *mtl, seen.dissolve = 1, mtl = &seen;
    names.name_material(static_cast<std::uint32_t>(scene_.materials.size()), name);
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
