#include "scene/obj_materials.h"

#include <algorithm>
#include <map>
#include <system_error>

#include "scene/files_read.h"
#include "scene/mesh_material.h"
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

void ObjMaterials::finish() {
  std::unordered_map<std::string_view, const MtlMaterial*> library;  // of several with one name, the first
  for (const MtlMaterial& m : library_) library.try_emplace(m.name, &m);
  std::size_t n_missing = 0;
  std::string first_missing;
  bool any_picture = false;
  std::map<std::string, std::size_t> left_out;  // materials, by the statement
  for (const std::string& name : names_) {
    const auto found = library.find(name);
    const MtlMaterial* mtl = found == library.end() ? nullptr : found->second;
    scene_.materials.push_back(mtl ? whitted_from_mtl(*mtl) : mesh_material());
    any_picture = any_picture || (mtl && mtl->has_picture);
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
  if (any_picture) {
    scene_.warnings.push_back(file_.string() +
                              ": pictures (map_Kd) are left out: the colours of Kd are used");
  }
}

}  // namespace kdray::scene
