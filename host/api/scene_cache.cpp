#include <cstdlib>

#include "cache/cache.h"
#include "kdray/kdray.h"

namespace kdray {

namespace fs = std::filesystem;

// The XDG base directory specification: a relative path in its variable counts as none.
fs::path SceneCache::default_folder() {
  if (const char* const own = std::getenv("KDRAY_CACHE_DIR")) return own;
  if (const char* const caches = std::getenv("XDG_CACHE_HOME"); caches && fs::path(caches).is_absolute())
    return fs::path(caches) / "kdray" / "scenes";
  if (const char* const home = std::getenv("HOME"); home && fs::path(home).is_absolute())
    return fs::path(home) / ".cache" / "kdray" / "scenes";
  return {};
}

std::optional<PreparedScene> SceneCache::find(const fs::path& file, const TreeOptions& tree) const {
  std::optional<prepare::Prepared> found = cache::find(options_, file, tree);
  if (!found) return std::nullopt;
  return PreparedScene(std::move(*found));
}

bool SceneCache::keep(const PreparedScene& scene) const {
  return cache::keep(options_, scene.prepared());
}

}  // namespace kdray
