#include "prepare/prepared.h"

#include "kdray/kdray.h"

namespace kdray {

namespace {

prepare::Prepared prepare_loaded(const Scene& scene, const TreeOptions& tree) {
  prepare::Prepared prepared = prepare::prepare(scene.model(), tree);
  prepared.seconds.load = scene.load_seconds();
  return prepared;
}

}  // namespace

PreparedScene::PreparedScene(const Scene& scene, const TreeOptions& tree)
    : PreparedScene(prepare_loaded(scene, tree)) {}
PreparedScene::PreparedScene(prepare::Prepared&& prepared)
    : prepared_(std::make_shared<const prepare::Prepared>(std::move(prepared))) {}

const std::vector<std::string>& PreparedScene::warnings() const {
  return prepared_->settings.warnings;
}
const scene::Scene& PreparedScene::settings() const {
  return prepared_->settings;
}

}  // namespace kdray
