#include <cstdlib>

#include "accel/cache/cache.h"
#include "accel/prepare/prepared.h"
#include "accel/prepare/view.h"
#include "base/cache_folder.h"
#include "base/paged.h"
#include "kdray/kdray.h"
#include "kdray/scene.h"
#include "scene/model/frame.h"

namespace kdray {

namespace {

prepare::Prepared prepare_loaded(const Scene& scene, const TreeOptions& tree) {
  prepare::Prepared prepared = prepare::prepare(scene.model(), tree);
  prepared.seconds.load = scene.load_seconds();
  return prepared;
}

std::optional<dvec3> vector_of(const std::optional<View::Vector>& v) {
  if (!v) return std::nullopt;
  return dvec3((*v)[0], (*v)[1], (*v)[2]);
}

scene::View view_of(const View& view) {
  scene::View v{.camera = view.camera,
                .from = vector_of(view.from),
                .at = vector_of(view.at),
                .up = vector_of(view.up),
                .side = vector_of(view.side),
                .vertical_fov = {},
                .ortho_width = view.ortho_width,
                .aperture = view.aperture,
                .focus = view.focus,
                .headlight = view.headlight,
                .background = {}};
  if (view.fov) v.vertical_fov = glm::radians(*view.fov);
  if (const auto& b = view.background) v.background = vec3((*b)[0], (*b)[1], (*b)[2]);
  return v;
}

double aspect_of(const scene::Scene& scene, int width, int height) {
  return width > 0 && height > 0 ? static_cast<double>(width) / height
                                 : scene::aspect_of(scene::settings_of(scene));
}

}  // namespace

PreparedScene::PreparedScene(const Scene& scene, const TreeOptions& tree)
    : PreparedScene(prepare_loaded(scene, tree)) {}
PreparedScene::PreparedScene(prepare::Prepared&& prepared)
    : prepared_(std::make_shared<const prepare::Prepared>(std::move(prepared))) {}

const std::vector<std::string>& PreparedScene::warnings() const {
  return prepared_->settings.warnings;
}
PreparedScene PreparedScene::seen(const View& view, int width, int height) const {
  return PreparedScene(prepare::seen(*prepared_, view_of(view), aspect_of(settings(), width, height)));
}
PreparedScene PreparedScene::seen_after(const scene::Scene& first, const View& view, int width,
                                        int height) const {
  return PreparedScene(
      prepare::seen(*prepared_, view_of(view), aspect_of(settings(), width, height), &first));
}
PreparedScene PreparedScene::in_studio(bool instead) const {
  return PreparedScene(prepare::in_studio(*prepared_, instead));
}
PreparedScene PreparedScene::coverage() const {
  return PreparedScene(prepare::shining(*prepared_, vec3(1), false));
}
PreparedScene PreparedScene::backdrop() const {
  return PreparedScene(prepare::shining(*prepared_, vec3(0), true));
}
void check_view(const scene::Scene& scene, const View& view) {
  static_cast<void>(scene::camera_of(scene, view_of(view), 1));
}
const scene::Scene& PreparedScene::settings() const {
  return prepared_->settings;
}

std::filesystem::path SceneCache::default_folder() {
  if (const char* const own = std::getenv("KDRAY_CACHE_DIR")) return own;
  const std::filesystem::path caches = user_cache_folder();
  return caches.empty() ? caches : caches / "scenes";
}

std::optional<PreparedScene> SceneCache::find(const std::filesystem::path& file, const TreeOptions& tree,
                                              const LoadOptions& load) const {
  std::optional<prepare::Prepared> found = cache::find(options_, file, tree, load);
  if (!found) return std::nullopt;
  return PreparedScene(std::move(*found));
}

bool SceneCache::keep(const PreparedScene& scene) const {
  return cache::keep(options_, scene.prepared());
}

void set_texture_cache(std::uint64_t bytes) {
  set_paged_budget(bytes);
}

}  // namespace kdray
