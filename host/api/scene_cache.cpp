#include <cstdlib>

#include "accel/cache/cache.h"
#include "base/cache_folder.h"
#include "kdray/kdray.h"

namespace kdray {

namespace fs = std::filesystem;

fs::path SceneCache::default_folder() {
  if (const char* const own = std::getenv("KDRAY_CACHE_DIR")) return own;
  const fs::path caches = user_cache_folder();
  return caches.empty() ? caches : caches / "scenes";
}

std::optional<PreparedScene> SceneCache::find(const fs::path& file, const TreeOptions& tree,
                                              const LoadOptions& load) const {
  std::optional<prepare::Prepared> found = cache::find(options_, file, tree, load);
  if (!found) return std::nullopt;
  return PreparedScene(std::move(*found));
}

bool SceneCache::keep(const PreparedScene& scene) const {
  return cache::keep(options_, scene.prepared());
}

}  // namespace kdray
