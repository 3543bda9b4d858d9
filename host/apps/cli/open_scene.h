// What    The way to a prepared scene and an open device that render and trace share: the scene from the
//         cache, or read and built, while the device is being opened beside it.
// Errors  kdray::Error; but a cache that can't be written costs no picture: a warning where it was asked for
//         by name.
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "api/hooks.h"
#include "apps/cli/options.h"
#include "apps/cli/progress.h"
#include "apps/cli/scene_input.h"
#include "kdray/kdray.h"

namespace kdray::cli {

// What is different where there are ranks.
struct OpeningByRanks {
  bool in_shares = false;               // each is to have a share of the scene, which no cache keeps
  std::function<void()> before_lookup;  // in the cache, if there is one
};

class OpenedScene {
 public:
  // `check` sees the scene's settings before any tree is built. Prints the scene's warnings, unless `quiet`.
  OpenedScene(const SceneInput& input, const TreeOptions& tree, const DeviceOptions& device,
              const CacheChoice& cache, bool quiet,
              const std::function<void(const scene::Scene&)>& check = {}, const api::Hooks& hooks = {},
              const OpeningByRanks& ranks = {});

  const PreparedScene& scene() const { return *scene_; }

  // Returns the whole scene where this process holds a share of it; else null.
  const std::shared_ptr<const api::WholeScene>& whole() const { return whole_; }

  // Returns the options to make the Renderer with.
  const DeviceOptions& device() const { return device_; }

  // Puts a scene that was not found into the cache; once.
  void keep_scene();
  // Puts a scene and programs that were not found into the cache; best after the picture is out, which it
  // would only delay.
  void keep();

  // Returns whether a scene from this file is looked for in a cache at all.
  static bool has_cache(const SceneInput& input, const CacheChoice& cache);

  const std::string& cache() const { return outcome_; }  // "hit", "miss" or "off"

  // Adds the times of what was done here: cache, load, keep_programs; and the part of start and self_test
  // that was waited for, since the device is opened while the scene is read.
  void add_to(Statistics::Seconds& seconds) const;

 private:
  using Tell = std::function<void(const scene::Scene&)>;

  void wait_for(std::future<OpenSeconds>& device);
  bool open_partition(const SceneInput& input, const TreeOptions& tree, const Tell& tell);
  bool find(const SceneInput& input, const TreeOptions& tree, const Tell& tell);
  void read(const SceneInput& input, const TreeOptions& tree, const Tell& tell);
  void tell_more(const std::vector<std::string>& warnings, std::size_t told) const;

  CacheChoice choice_;
  SceneCache cache_;
  bool quiet_;
  BuildNotice notice_;
  std::set<std::string> left_out_;  // what was said about devices that are left out
  DeviceOptions device_;
  std::string outcome_ = "off";
  bool is_kept_ = false;
  Statistics::Seconds seconds_;
  std::optional<PreparedScene> scene_;
  std::shared_ptr<const api::WholeScene> whole_;
};

}  // namespace kdray::cli
