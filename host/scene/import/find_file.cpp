#include "scene/import/find_file.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "scene/import/files_read.h"
#include "scene/import/lower.h"
#include "scene/import/text_scanner.h"

namespace kdray::scene {

namespace {

namespace fs = std::filesystem;

thread_local fs::path asset_root;

// The only entry of the folder whose name is this but for capitals; empty: none, or several.
fs::path entry_like(const fs::path& folder, const std::string& name) {
  std::error_code error;
  fs::path found;
  fs::directory_iterator entry(folder.empty() ? "." : folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const fs::path there = entry->path().filename();
    if (!same_word(there.string(), name)) continue;
    if (!found.empty()) return {};
    found = folder / there;
  }
  return found;
}

fs::path in_other_capitals(const fs::path& path) {
  std::error_code ignored;
  fs::path at;
  for (const fs::path& part : path) {
    const fs::path exact = at / part;
    at = fs::exists(exact, ignored) ? exact : entry_like(at, part.string());
    if (at.empty()) return {};
  }
  return fs::is_regular_file(at, ignored) ? at : fs::path();
}

bool is_inside(const fs::path& path, const fs::path& folder) {
  std::error_code error;
  const fs::path inner = fs::weakly_canonical(path, error);
  if (error) return false;
  const fs::path outer = fs::canonical(folder, error);
  if (error) return false;
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

}  // namespace

std::string slashed(std::string_view name) {
  std::string out(name);
  std::ranges::replace(out, '\\', '/');
  return out;
}

std::string_view unquoted(std::string_view name) {
  const bool quoted =
      name.size() > 2 && (name.front() == '"' || name.front() == '\'') && name.back() == name.front();
  return quoted ? name.substr(1, name.size() - 2) : name;
}

fs::path find_file(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored)) return path;
  FilesRead::add_missing(path);
  return in_other_capitals(path);
}

bool may_name(const fs::path& folder, const fs::path& name) {
  const fs::path normal = name.lexically_normal();
  if (!normal.empty() && !normal.has_root_path() && *normal.begin() != "..") return true;
  if (asset_root.empty()) return false;
  // The file itself where there is one: its name may be a link, or differ in capitals.
  const fs::path path = folder / name, other = in_other_capitals(path);
  return is_inside(other.empty() ? path : other, asset_root);
}

std::string outside(std::string_view name) {
  return "'" + printable(name) + "' is not a file beside the scene, or below";
}

AssetRoot::AssetRoot(fs::path folder) : outer_(std::exchange(asset_root, std::move(folder))) {}

AssetRoot::~AssetRoot() {
  asset_root = std::move(outer_);
}

}  // namespace kdray::scene
