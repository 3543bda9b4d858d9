#include "apps/cli/tune_lab.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <future>

#include "base/timer.h"
#include "scene/generate/built_in.h"
#include "scene/model/scene.h"

namespace kdray::cli {

namespace {

// The first pixel that differs in a bit.
std::string difference(const Picture& picture, const Picture& reference) {
  if (picture.width != reference.width || picture.height != reference.height) return "another size";
  const std::size_t n = picture.rgb.size();
  if (n != reference.rgb.size()) return "values are missing";
  if (std::memcmp(picture.rgb.data(), reference.rgb.data(), n * sizeof(float)) == 0) return "";
  for (std::size_t i = 0; i < n; ++i)
    if (std::memcmp(&picture.rgb[i], &reference.rgb[i], sizeof(float)) != 0)
      return fmt::format("pixel {}, {} differs", i / 3 % static_cast<std::size_t>(picture.width),
                         i / 3 / static_cast<std::size_t>(picture.width));
  return "";
}

Scene load_checked(const std::string& name, const std::function<void(const scene::Scene&)>& check) {
  scene::Scene scene = generate::load_scene(name);
  check(scene);
  return Scene(std::move(scene));
}

}  // namespace

TuneScene::TuneScene(const std::string& name, const DeviceOptions& device, const RenderOptions& render,
                     const std::function<void(const scene::Scene&)>& check)
    : name_(name),
      options_(render),
      renderer_(PreparedScene(load_checked(name, check),
                              {.binary_form = takes_binary_form(render.traversal, render.precision)}),
                device),
      reference_(TuneScene::render({})) {}

tuning::Key TuneScene::key() const {
  const Statistics::DeviceTuning& tuning = renderer_.statistics().tuning;
  return {tuning.device, tuning.driver, tuning.kernels, tuning.schedule, tuning.features};
}

Picture TuneScene::render(const Tuning& tuning) {
  renderer_.tune(tuning);
  return renderer_.render(options_);
}

std::string TuneScene::fault(const Tuning& tuning) {
  const std::string differs = difference(render(tuning), reference_);
  return differs.empty() ? "" : name_ + ": " + differs;
}

double TuneScene::seconds(const Tuning& tuning) {
  render(tuning);
  return renderer_.statistics().seconds.render;
}

namespace {

// By a thread each, so that compilers work side by side; this is not timed.
std::string first_fault(TuneScenes& scenes, const Tuning& tuning) {
  std::vector<std::future<std::string>> looks;
  for (const auto& scene : scenes)
    looks.push_back(std::async(std::launch::async, [&scene, &tuning] { return scene->fault(tuning); }));
  std::string first;
  for (auto& look : looks)
    if (const std::string fault = look.get(); first.empty()) first = fault;
  return first;
}

}  // namespace

tuning::Lab make_lab(TuneScenes& scenes, const Injection& injection, std::function<void(double)> progress) {
  tuning::Lab lab;
  lab.fault = [&scenes, injection](const Tuning& tuning) {
    return injection.hits(tuning) ? "told to be wrong" : first_fault(scenes, tuning);
  };
  lab.measure = [&scenes](const Tuning& tuning) {
    std::vector<double> seconds;
    for (const auto& scene : scenes) seconds.push_back(scene->seconds(tuning));
    return seconds;
  };
  lab.now = [timer = Timer()] { return timer.seconds(); };
  lab.progress = std::move(progress);
  return lab;
}

std::vector<TuneScenes> by_key(TuneScenes scenes) {
  std::vector<TuneScenes> groups;
  for (auto& scene : scenes) {
    const auto same = std::ranges::find_if(
        groups, [&](const TuneScenes& group) { return group.front()->key() == scene->key(); });
    TuneScenes& group = same == groups.end() ? groups.emplace_back() : *same;
    group.push_back(std::move(scene));
  }
  return groups;
}

}  // namespace kdray::cli
