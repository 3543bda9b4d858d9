#include "apps/cli/open_scene.h"

#include <algorithm>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <utility>

#include "accel/prepare/prepared.h"
#include "api/hooks.h"
#include "api/open_devices.h"
#include "apps/cli/output.h"
#include "apps/cli/ranks.h"
#include "base/process_memory.h"
#include "base/timer.h"
#include "cluster/partition/scene_partition.h"
#include "scene/model/scene.h"

namespace kdray::cli {

namespace {

const std::string kCacheHit = "hit", kCacheMiss = "miss";

CacheOptions options_of(const CacheChoice& choice) {
  CacheOptions options;
  options.max_bytes = choice.max_bytes;
  if (choice.off) return options;
  options.folder = choice.folder;
  if (choice.folder.empty()) options.folder = SceneCache::default_folder();
  return options;
}

// Returns the options with a folder for programs beside that of the scenes.
DeviceOptions with_cache(DeviceOptions device, const CacheChoice& choice) {
  if (!choice.off)
    device.programs =
        choice.folder.empty() ? default_program_folder() : std::filesystem::path(choice.folder) / "programs";
  return device;
}

// What a rank has of the scene, and what it knows of all of it.
struct PartitionedScene {
  prepare::Prepared prepared;
  std::shared_ptr<const api::WholeScene> whole;
};

// Reads this rank's share of the scene. All ranks call it. `check` sees the settings before a tree is built.
// Returns nothing where the scene has instances, so that every rank needs all of it.
std::optional<PartitionedScene> partition_scene(const SceneInput& input, const TreeOptions& tree, bool quiet,
                                                const std::function<void(const scene::Scene&)>& check) {
  const std::shared_ptr<transport::Together> all = together_of_this_run();
  std::optional<partition::ScenePartition> own =
      partition::partition_scene(input.file, input.load, tree, *all, check);
  if (!own) {
    if (!quiet) say("every rank holds the whole scene: one with instances isn't divided");
    return std::nullopt;
  }
  return PartitionedScene{std::move(own->prepared), std::make_shared<const api::WholeScene>(
                                                        api::WholeScene{own->core, own->primitives, all})};
}

}  // namespace

OpenedScene::OpenedScene(const SceneInput& input, const TreeOptions& tree, const DeviceOptions& device,
                         const CacheChoice& choice, bool quiet,
                         const std::function<void(const scene::Scene&)>& check, const api::Hooks& hooks,
                         const OpeningByRanks& ranks)
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
  api::leave_out_drivers(device_);  // sets environment variables, which a thread of its own must not
  std::future<OpenSeconds> device_opened =
      std::async(std::launch::async, [&] { return api::open_device(device_, hooks); });
  const auto tell = [&](const scene::Scene& settings) {
    if (check) check(settings);
    if (!quiet)
      for (const std::string& warning : settings.warnings) say(warning);
    wait_for(device_opened);
  };
  if (ranks.in_shares) wait_for(device_opened);
  if (ranks.in_shares && open_partition(input, tree, tell)) return;
  if (has_cache(input, choice)) {
    if (ranks.before_lookup) ranks.before_lookup();
    if (find(input, tree, tell)) return;
  }
  read(input, tree, tell);
}

// Returns false where the scene is none that is divided. The device is open before, so that the memory for
// compiling the self-test is not needed at the same time as that for reading and building.
bool OpenedScene::open_partition(const SceneInput& input, const TreeOptions& tree, const Tell& tell) {
  std::size_t told = 0;
  give_back_free_memory();
  std::optional<PartitionedScene> share =
      partition_scene(input, tree, quiet_, [&](const scene::Scene& settings) {
        told = settings.warnings.size();
        tell(settings);
      });
  give_back_free_memory();
  if (!share) return false;
  seconds_.load = share->prepared.seconds.load;
  scene_.emplace(std::move(share->prepared));
  whole_ = share->whole;
  tell_more(scene_->warnings(), told);
  return true;
}

bool OpenedScene::find(const SceneInput& input, const TreeOptions& tree, const Tell& tell) {
  const Timer look_up;
  scene_ = cache_.find(input.file, tree, input.load);
  outcome_ = scene_ ? kCacheHit : kCacheMiss;
  seconds_.cache = look_up.seconds();
  if (scene_) tell(scene_->settings());
  return scene_.has_value();
}

void OpenedScene::read(const SceneInput& input, const TreeOptions& tree, const Tell& tell) {
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
  tell_more(scene_->warnings(), read.model().warnings.size());
}

// Says the warnings that came after the first `told`: whether all is in range and fits is known only when the
// tree is built.
void OpenedScene::tell_more(const std::vector<std::string>& warnings, std::size_t told) const {
  if (quiet_) return;
  for (std::size_t i = told; i < warnings.size(); ++i) say(warnings[i]);
}

// A scene from standard input could not be found again.
bool OpenedScene::has_cache(const SceneInput& input, const CacheChoice& choice) {
  return !options_of(choice).folder.empty() && !input.is_stdin();
}

void OpenedScene::keep() {
  keep_scene();
  const Timer timer;
  keep_programs(device_);
  seconds_.keep_programs = timer.seconds();
}

// Waits for the device, once. The self-test is the last part of opening it.
void OpenedScene::wait_for(std::future<OpenSeconds>& device) {
  if (!device.valid()) return;
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
  if (outcome_ != kCacheMiss || is_kept_) return;
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
