#include "bench/rays/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "api/statistics_json.h"
#include "bench/embree/embree.h"
#include "bench/measure/cores.h"
#include "bench/race/kdray_contestants.h"
#include "bench/workload/scenes.h"

namespace kdray::bench {

namespace {

std::vector<std::string> all_of(std::span<const std::string_view> names) {
  return {names.begin(), names.end()};
}

// Where the renderer will take a GPU there is no one core: a GPU can't be divided.
std::vector<int> default_cores() {
  for (const DeviceInfo& device : devices())
    if (device.usable && device.kind != "cpu") return {0};
  return {1, 0};
}

RaysOptions resolved(RaysOptions o) {
  if (o.scenes.empty()) o.scenes = default_scenes();
  if (o.classes.empty()) o.classes = all_of(class_names());
  if (o.traversals.empty()) o.traversals = all_of(traversal_names());
  if (o.cores.empty()) o.cores = default_cores();
  return o;
}

int side_of(int rays) {
  return std::max(1, static_cast<int>(std::sqrt(static_cast<double>(rays))));
}

std::size_t n_hits(const std::vector<Hit>& hits) {
  return static_cast<std::size_t>(
      std::count_if(hits.begin(), hits.end(), [](const Hit& h) { return std::isfinite(h.t); }));
}

class RaysScene {
 public:
  RaysScene(const RaysOptions& options, const std::string& name,
            const std::function<void(const std::string&)>& working)
      : options_(options), name_(name), working_(working), scene_(load_scene(name)) {
    if (scene_.model().primitive_count() == 0)
      throw Error(ErrorCode::input, name + ": nothing to trace; the scene is empty");
    if (options.embree) embree_ = make_embree_scenes(scene_.model());
  }

  RaysRun run(int cores) {
    make_rays();
    DeviceOptions device;
    device.device = options_.device;
    device.compute_units = cores;
    // Each walk has the tree that `kdray trace` would make for it.
    std::array<std::shared_ptr<Renderer>, 2> renderers;
    std::vector<Contestant> contestants;
    for (const std::string& name : options_.traversals) {
      if (name == "binary" && !has_binary()) continue;
      const bool binary = has_binary() && takes_binary_form(traversal_of(name), Precision::float32);
      auto& renderer = renderers[binary ? 1 : 0];
      if (!renderer)
        renderer = std::make_shared<Renderer>(scene_, TreeOptions{.binary_form = binary}, device);
      contestants.push_back(kdray_contestant(renderer, name));
    }
    const auto& any = renderers[renderers[0] ? 0 : 1];
    RaysRun run = described(api::device_json(any->statistics()));
    if (options_.embree)
      for (Contestant& c : embree_contestants(embree_, run.cores)) contestants.push_back(std::move(c));
    for (std::size_t i = 0; i < classes_.size(); ++i)
      run.classes.push_back(race_on(classes_[i], references_[i], contestants, run.cores));
    return run;
  }

 private:
  RaysRun described(const nlohmann::json& device) const {
    const scene::Scene& model = scene_.model();
    return {.scene = name_,
            .n_primitives = kind_counts(model),
            .n_instances = model.instances.size(),
            .cores = cores_of(device),
            .device = device.at("name"),
            .vectors = device.value("vectors", ""),
            .classes = {}};
  }

  // Once for all numbers of cores, on the whole device: the binary traversal is slow, and its hits are the
  // same on each.
  void make_rays() {
    if (!classes_.empty()) return;
    working_(fmt::format("{}: making rays", name_));
    DeviceOptions device;
    device.device = options_.device;
    Renderer renderer(scene_, TreeOptions{.binary_form = has_binary()}, device);
    const Traversal walk = has_binary() ? Traversal::binary : Traversal::wide;
    classes_ = make_classes(scene_.model(), options_.classes, side_of(options_.rays),
                            [&](std::span<const Ray> rays) { return renderer.trace(rays, false, 1, walk); });
    for (const RayClass& c : classes_) references_.push_back(renderer.trace(c.rays, c.any_hit, 1, walk));
  }

  // The binary walk can't follow instances.
  bool has_binary() const { return scene_.model().instances.empty(); }

  ClassResult race_on(const RayClass& c, const std::vector<Hit>& reference,
                      const std::vector<Contestant>& contestants, int cores) {
    ClassResult result{c.name, c.any_hit, c.rays.size(), n_hits(reference), {}};
    if (c.rays.empty()) return result;
    working_(fmt::format("{}, {} core{}: {}", name_, cores, cores == 1 ? "" : "s", c.name));
    result.outcomes = race(c, reference, contestants, options_.repeat);
    return result;
  }

  const RaysOptions& options_;
  std::string name_;
  const std::function<void(const std::string&)>& working_;
  Scene scene_;
  EmbreeScenes embree_;
  std::vector<RayClass> classes_;
  std::vector<std::vector<Hit>>
      references_;  // of each class, the binary walk's hits, of instances the wide one's
};

}  // namespace

std::vector<std::string> default_scenes() {
  std::vector<std::string> names = {"boxes",
                                    "spheres",
                                    "balls",
                                    "rings",
                                    "meadow",
                                    "displaced:50000",
                                    "displaced:200000",
                                    "displaced:10000000"};
  for (std::string& name : data_scenes().here) names.push_back(std::move(name));
  return names;
}

std::vector<RaysRun> bench_rays(const RaysOptions& options, const std::function<void(const RaysRun&)>& done,
                                const std::function<void(const std::string&)>& working) {
  const RaysOptions o = resolved(options);
  std::vector<RaysRun> runs;
  for (const std::string& name : o.scenes) {
    RaysScene bench(o, name, working);
    for (const int cores : o.cores) {
      runs.push_back(bench.run(cores));
      done(runs.back());
    }
  }
  return runs;
}

std::size_t count_not_identical(std::span<const RaysRun> runs) {
  std::size_t n = 0;
  for (const RaysRun& run : runs)
    for (const ClassResult& c : run.classes)
      for (const Outcome& o : c.outcomes) n += o.n_not_identical;
  return n;
}

}  // namespace kdray::bench
