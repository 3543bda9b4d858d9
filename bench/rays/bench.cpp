#include "bench/rays/bench.h"

#include <fmt/format.h>

#include <array>
#include <memory>

#include "bench/embree/embree.h"
#include "bench/race/compare.h"
#include "bench/race/race.h"
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

class RaysScene {
 public:
  RaysScene(const RaysOptions& options, const std::string& name, const Working& working)
      : options_(options), name_(name), working_(working), scene_(load_scene(name)) {
    if (scene_.model().primitive_count() == 0)
      throw Error(ErrorCode::input, name + ": nothing to trace; the scene is empty");
    if (options.embree) embree_ = make_embree_scenes(scene_.model());
  }

  RaysRun run(int cores) {
    make_rays();
    const DeviceOptions device{.device = options_.device, .compute_units = cores};
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
    const scene::Scene& model = scene_.model();
    RaysRun run{name_, kind_counts(model), model.instances.size(), machine_of(any->statistics()), {}};
    for (Contestant& c : embree_contestants(embree_, run.machine.cores)) contestants.push_back(std::move(c));
    for (std::size_t i = 0; i < classes_.size(); ++i)
      run.classes.push_back(race_on(classes_[i], references_[i], contestants, run.machine.cores));
    return run;
  }

 private:
  // Once for all numbers of cores, on the whole device: the binary traversal is slow, and its hits are the
  // same on each.
  void make_rays() {
    if (!classes_.empty()) return;
    working_(fmt::format("{}: making rays", name_));
    Renderer renderer(scene_, TreeOptions{.binary_form = has_binary()}, {.device = options_.device});
    const Traversal walk = has_binary() ? Traversal::binary : Traversal::wide;
    classes_ = make_classes(scene_.model(), options_.classes, side_of(options_.rays),
                            [&](std::span<const Ray> rays) { return renderer.trace(rays, false, 1, walk); });
    for (const RayClass& c : classes_) references_.push_back(renderer.trace(c.rays, c.any_hit, 1, walk));
  }

  // The binary walk can't follow instances.
  bool has_binary() const { return scene_.model().instances.empty(); }

  ClassResult race_on(const RayClass& c, const std::vector<Hit>& reference,
                      const std::vector<Contestant>& contestants, int cores) {
    ClassResult result{c.name, c.any_hit, c.rays.size(), count_hits(reference), {}};
    if (c.rays.empty()) return result;
    working_(fmt::format("{}, {}: {}", name_, counted(cores, "core"), c.name));
    result.outcomes = race(c, reference, contestants, options_.repeat);
    return result;
  }

  const RaysOptions& options_;
  std::string name_;
  const Working& working_;
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

std::vector<RaysRun> bench_rays(const RaysOptions& options, const Progress<RaysRun>& progress) {
  const RaysOptions o = resolved(options);
  std::vector<RaysRun> runs;
  for (const std::string& name : o.scenes) {
    RaysScene bench(o, name, progress.working);
    for (const int cores : o.cores) {
      runs.push_back(bench.run(cores));
      progress.done(runs.back());
    }
  }
  return runs;
}

std::size_t count_not_identical(std::span<const RaysRun> runs) {
  return count_over(runs, [](const RaysRun& run) {
    return count_over(run.classes, [](const ClassResult& c) {
      return count_over(c.outcomes, [](const Outcome& o) { return o.n_not_identical; });
    });
  });
}

}  // namespace kdray::bench
