#include "cli/open_scene.h"

#include <future>

#include "base/timer.h"
#include "cli/message.h"
#include "scene/scene.h"

namespace kdray::cli {

namespace {

const std::string kHit = "hit", kMiss = "miss";

CacheOptions options_of(const CacheChoice& choice) {
  CacheOptions options;
  options.max_bytes = choice.max_bytes;
  if (choice.off) return options;
  options.folder = choice.folder;
  if (choice.folder.empty()) options.folder = SceneCache::default_folder();
  return options;
}

}  // namespace

OpenedScene::OpenedScene(const std::string& file, const TreeOptions& tree, const DeviceOptions& device,
                         const CacheChoice& choice, bool quiet,
                         const std::function<void(const scene::Scene&)>& check)
    : choice_(choice), cache_(options_of(choice)), quiet_(quiet) {
  std::future<void> device_opened = std::async(std::launch::async, [&device] { open_device(device); });
  const auto tell = [&](const scene::Scene& settings) {
    if (!quiet)
      for (const std::string& warning : settings.warnings) say(warning);
    if (check) check(settings);
    device_opened.get();
  };
  const bool has_cache = !options_of(choice).folder.empty();
  const Timer look_up;
  scene_ = cache_.find(file, tree);
  if (has_cache) {
    outcome_ = scene_ ? kHit : kMiss;
    cache_seconds_ = look_up.seconds();
  }
  if (scene_) {
    tell(scene_->settings());
    return;
  }
  const Scene read = Scene::load(file);
  load_seconds_ = read.load_seconds();
  tell(read.model());  // without a device there is no use in building a tree
  scene_.emplace(read, tree);
}

void OpenedScene::keep() {
  if (outcome_ != kMiss) return;
  const Timer timer;
  try {
    cache_.keep(*scene_);
  } catch (const Error& error) {
    if (!choice_.folder.empty() && !quiet_) say(error.what());
  }
  cache_seconds_ += timer.seconds();
}

}  // namespace kdray::cli
