#include "accel/cache/cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <system_error>

#include "accel/cache/entry.h"
#include "base/cache_folder.h"
#include "base/error.h"
#include "fingerprint.h"
#include "layout/base.layout.h"
#include "scene/import/files.h"

namespace kdray::cache {

namespace fs = std::filesystem;

namespace {

using scene::FileRead;

constexpr std::string_view kEnding = ".scene";

std::optional<Hash> content_of(const fs::path& file) {
  const std::optional<MappedFile> mapped = map_file(file);
  if (!mapped) return std::nullopt;
  return hash_of(mapped->bytes());
}

// Entries name files from the scene's folder, so that they hold from wherever the scene is named.
std::vector<FileRead> from_folder(std::vector<FileRead> files, const fs::path& folder) {
  for (FileRead& file : files) {
    const fs::path relative = file.path.lexically_relative(folder);
    if (!folder.empty() && !relative.empty()) file.path = relative;
  }
  return files;
}

// The first file is the scene's own, whose content is in the key.
bool all_as_they_were(const std::vector<FileRead>& files, const fs::path& folder) {
  return std::all_of(files.begin() + 1, files.end(), [&](const FileRead& file) {
    if (file.only_named) return true;
    std::error_code error;
    const fs::path path = folder / file.path;
    return file.content ? content_of(path) == file.content : !fs::is_regular_file(path, error);
  });
}

// Warnings that are kept name the scene as it was named then: under another name they would be wrong.
bool says_the_same(const scene::Scene& settings, const fs::path& scene) {
  return settings.warnings.empty() || settings.name == scene.string();
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw input_error(folder.string(), 0, "the scene cache can't be made: " + error.message(),
                      "name another folder (--cache)");
}

}  // namespace

Hash key_of(const std::filesystem::path& file, const Hash& content, const TreeOptions& tree,
            const LoadOptions& load) {
  // All options are named here, so that one that is added fails to compile.
  const auto& [quality, max_depth, cost_traverse, cost_intersect, memory_bytes, binary_form, geometry] = tree;
  static_cast<void>(geometry);  // doubles are not kept
  const auto& [smooth_degrees, time, animation, texture_bytes, instances, asset_root] = load;
  // The ending decides how bytes are read; numbers are written so that no bit is lost.
  const std::string text = fmt::format(
      "kdray {}, code {}, compiler {}, layout {}, words of {} bytes\n{} {}\n{}\nquality {}, depth {}, costs "
      "{:a} {:a}, "
      "memory {}, binary {}, smooth {:a}, time {}, animation {}, textures {}, instances {}, assets {}",
      KDRAY_VERSION, KDRAY_FINGERPRINT, __VERSION__, KDRAY_LAYOUT_VERSION, sizeof(void*),
      scene::format_of(file), file.extension().string(), in_hex(content), static_cast<int>(quality),
      max_depth, cost_traverse, cost_intersect, memory_bytes, binary_form.value_or(true),
      smooth_degrees.value_or(-1), time ? fmt::format("{:a}", *time) : "none", animation, texture_bytes,
      static_cast<int>(instances), asset_root.empty() ? "" : std::filesystem::absolute(asset_root).string());
  return hash_of(text);
}

std::optional<prepare::Prepared> find(const CacheOptions& cache, const fs::path& scene,
                                      const TreeOptions& tree, const LoadOptions& load) {
  if (cache.folder.empty() || tree.geometry != VertexPrecision::float32) return std::nullopt;
  const std::optional<Hash> content = content_of(scene);
  if (!content) return std::nullopt;
  const Hash key = key_of(scene, *content, tree, load);
  const fs::path file = entry_file(cache.folder, key, kEnding);
  std::optional<prepare::Prepared> found = read_entry(file, key);
  if (!found || found->settings.files.empty() || !says_the_same(found->settings, scene) ||
      !all_as_they_were(found->settings.files, scene.parent_path()))
    return std::nullopt;
  for (FileRead& named : found->settings.files) named.path = scene.parent_path() / named.path;
  found->settings.files.front().path = scene;  // it may have had another name
  found->settings.name = scene.string();
  found->settings.load_options = load;
  found->tree_options = tree;
  touch_entry(file);
  return found;
}

bool keep(const CacheOptions& cache, const prepare::Prepared& prepared) {
  const std::vector<FileRead>& files = prepared.settings.files;
  if (cache.folder.empty() || files.empty() || !files.front().content) return false;
  if (prepared.tree_options.geometry != VertexPrecision::float32) return false;  // nor is it looked for
  const std::uint64_t bytes = entry_bytes(prepared);
  if (bytes < cache.min_bytes || bytes > cache.max_bytes / 4) return false;
  const fs::path scene = files.front().path;
  const Hash key =
      key_of(scene, *files.front().content, prepared.tree_options, prepared.settings.load_options);
  prepare::Prepared kept = prepared;
  kept.settings.files = from_folder(files, scene.parent_path());
  make_folder(cache.folder);
  write_entry(entry_file(cache.folder, key, kEnding), key, kept);
  shrink_folder(cache.folder, kEnding, cache.max_bytes);
  return true;
}

}  // namespace kdray::cache
