#include "scene/scene.h"

#include "base/timer.h"
#include "kdray/kdray.h"
#include "scene/load.h"

namespace kdray {

Scene Scene::load(const std::filesystem::path& file, const LoadOptions& options) {
  const Timer timer;
  Scene scene(scene::load(file, options));
  scene.load_seconds_ = timer.seconds();
  return scene;
}
Scene Scene::from_memory(std::string bytes, const std::filesystem::path& name, const LoadOptions& options) {
  const Timer timer;
  Scene scene(scene::load_from_memory(std::move(bytes), name, options));
  scene.load_seconds_ = timer.seconds();
  return scene;
}
Scene::Scene(scene::Scene&& model) : model_(std::make_unique<scene::Scene>(std::move(model))) {}
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

std::uint32_t Scene::primitives() const {
  return model_->primitive_count();
}
const std::vector<std::string>& Scene::warnings() const {
  return model_->warnings;
}
const scene::Scene& Scene::model() const {
  return *model_;
}

}  // namespace kdray
