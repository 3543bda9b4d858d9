#include "cli/open_scene.h"

#include <algorithm>
#include <filesystem>
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

// With programs in a folder beside the scenes.
DeviceOptions with_cache(DeviceOptions device, const CacheChoice& choice) {
  if (!choice.off)
    device.programs =
        choice.folder.empty() ? default_program_folder() : std::filesystem::path(choice.folder) / "programs";
  return device;
}

}  // namespace

OpenedScene::OpenedScene(const SceneInput& input, const TreeOptions& tree, const DeviceOptions& device,
                         const CacheChoice& choice, bool quiet,
                         const std::function<void(const scene::Scene&)>& check, const api::Hooks& hooks)
    : choice_(choice),
      cache_(options_of(choice)),
      quiet_(quiet),
      notice_(notice_on_stderr(quiet)),
      device_(with_cache(device, choice)) {
  device_.building = [this](bool begins) { notice_.tell(begins); };
  // The device is opened twice: here, and by the Renderer.
  device_.left_out = [this](const std::string& why) {
    if (!quiet_ && left_out_.insert(why).second) say(why);
  };
  if (!quiet) device_.tunings_ignored = [](const std::string& why) { say(why); };
  std::future<OpenSeconds> device_opened =
      std::async(std::launch::async, [&] { return api::open_device(device_, hooks); });
  const auto tell = [&](const scene::Scene& settings) {
    if (check) check(settings);
    if (!quiet)
      for (const std::string& warning : settings.warnings) say(warning);
    wait_for(device_opened);
  };
  const bool is_cached = has_cache(input, choice);
  const Timer look_up;
  if (is_cached) scene_ = cache_.find(input.file, tree, input.load);
  if (is_cached) {
    outcome_ = scene_ ? kHit : kMiss;
    seconds_.cache = look_up.seconds();
  }
  if (scene_) {
    tell(scene_->settings());
    return;
  }
  const Scene read = [&] {
    try {
      return load_scene(input);
    } catch (...) {
      notice_.mute();  // the device is waited for, but what it does is of no interest any more
      throw;
    }
  }();
  seconds_.load = read.load_seconds();
  tell(read.model());  // without a device there is no use in building a tree
  scene_.emplace(read, tree);
  // What the tree was built of is known to be in range, and to fit, only now.
  if (!quiet) {
    const std::vector<std::string>& warnings = scene_->settings().warnings;
    for (std::size_t i = read.model().warnings.size(); i < warnings.size(); ++i) say(warnings[i]);
  }
}

// A scene from standard input is no file that could be found again.
bool OpenedScene::has_cache(const SceneInput& input, const CacheChoice& choice) {
  return !options_of(choice).folder.empty() && !input.is_stdin();
}

void OpenedScene::keep() {
  keep_scene();
  const Timer timer;
  keep_programs(device_);
  seconds_.keep_programs = timer.seconds();
}

// The self-test comes last.
void OpenedScene::wait_for(std::future<OpenSeconds>& device) {
  const Timer timer;
  const OpenSeconds opened = device.get();
  const double waited = timer.seconds();
  seconds_.self_test = std::min(opened.self_test, waited);
  seconds_.start = waited - seconds_.self_test;
}

void OpenedScene::add_to(Statistics::Seconds& seconds) const {
  seconds.cache += seconds_.cache;
  seconds.load += seconds_.load;
  seconds.start += seconds_.start;
  seconds.self_test += seconds_.self_test;
  seconds.keep_programs += seconds_.keep_programs;
}

void OpenedScene::keep_scene() {
  if (outcome_ != kMiss || is_kept_) return;
  is_kept_ = true;
  const Timer timer;
  try {
    cache_.keep(*scene_);
  } catch (const Error& error) {
    if (!choice_.folder.empty() && !quiet_) say(error.what());
  }
  seconds_.cache += timer.seconds();
}

}  // namespace kdray::cli
