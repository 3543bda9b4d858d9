#include "bench/build/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "bench/embree/embree.h"
#include "bench/race/race.h"

namespace kdray::bench {

namespace {

class BuildScene {
 public:
  BuildScene(const BuildOptions& options, const std::string& name)
      : options_(options), name_(name), input_(name), scene_(input_.scene), geometry_(input_.geometry) {
    builders_ = quality_builders(geometry_.size());
    if (options.variants)
      for (Builder& b : thesis_builders(geometry_.size())) builders_.push_back(std::move(b));
  }

  BuildRun run(const Working& working) {
    BuildRun run{name_, kind_counts(geometry_), {}, {}};
    working(name_ + ": building");
    time_builds(run);
    working(name_ + ": tracing");
    time_traces(run);
    return run;
  }

 private:
  void time_builds(BuildRun& run) const {
    std::vector<TimedBuild> builds;
    for (const Builder& b : builders_) {
      run.builders.push_back({b.name, {}, {}, {}});
      builds.push_back([this, &b] { return time_build(scene_, geometry_, b.config); });
    }
    if (options_.embree)
      for (EmbreeBuild& embree : embree_builds(scene_, geometry_)) {
        run.builders.push_back({embree.name, {}, {}, {}});
        builds.push_back(std::move(embree.build));
      }
    const std::vector<BuildSpreads> seconds = race_builds(builds, options_.repeat);
    for (std::size_t i = 0; i < seconds.size(); ++i) run.builders[i].seconds = seconds[i];
  }

  void time_traces(BuildRun& run) const {
    std::vector<std::shared_ptr<Renderer>> renderers;
    std::vector<Contestant> contestants;
    for (std::size_t i = 0; i < builders_.size(); ++i) {
      prepare::Prepared made = prepare::prepare(scene_, geometry_, builders_[i].config);
      run.builders[i].tree = facts_of(made);
      renderers.push_back(std::make_shared<Renderer>(PreparedScene(std::move(made)), device()));
      Contestant contestant = kdray_contestant(renderers.back(), "auto");
      contestant.mode = builders_[i].name;
      contestants.push_back(std::move(contestant));
    }
    run.machine = machine_of(renderers.front()->statistics());
    if (options_.embree)
      for (Contestant& c : embree_contestants(make_embree_scenes(scene_), run.machine.cores))
        if (c.family == Family::embree_fast) contestants.push_back(std::move(c));
    race_classes(*renderers[balanced()], contestants, run);
  }

  std::size_t balanced() const {
    const auto found = std::find_if(builders_.begin(), builders_.end(),
                                    [](const Builder& b) { return b.name == "balanced"; });
    return static_cast<std::size_t>(found - builders_.begin());
  }

  void race_classes(Renderer& reference, const std::vector<Contestant>& contestants, BuildRun& run) const {
    for (const RayClass& c : build_rays(scene_, options_.rays, reference)) {
      const std::vector<Hit> hits = reference.trace(c.rays, c.any_hit, 1, Traversal::binary);
      const std::vector<Outcome> outcomes = race(c, hits, contestants, options_.repeat);
      for (BuilderResult& b : run.builders) {
        const Outcome* const o =
            b.tree ? find(outcomes, Family::kdray, b.builder) : best_of(outcomes, Family::embree_fast);
        b.traces.push_back({c.name, c.rays.size(), o->seconds, o->n_not_identical});
      }
    }
  }

  DeviceOptions device() const { return {.device = options_.device}; }

  const BuildOptions& options_;
  std::string name_;
  BuildInput input_;
  const scene::Scene& scene_;
  const scene::Geometry& geometry_;
  std::vector<Builder> builders_;
};

}  // namespace

double BuilderResult::trace_seconds() const {
  double seconds = 0;
  for (const TraceTimes& t : traces) seconds += 1e6 * t.seconds.median / static_cast<double>(t.n_rays);
  return seconds;
}

const BuilderResult* BuildRun::embree() const {
  const BuilderResult* fastest = nullptr;
  for (const BuilderResult& b : builders)
    if (!b.tree && (fastest == nullptr || b.seconds.total.median < fastest->seconds.total.median))
      fastest = &b;
  return fastest;
}

std::vector<RayClass> build_rays(const scene::Scene& scene, int rays, Renderer& renderer) {
  static const std::vector<std::string> kClasses = {"primary", "diffuse", "random"};
  std::vector<RayClass> classes =
      make_classes(scene, kClasses, side_of(rays), [&](std::span<const Ray> r) { return renderer.trace(r); });
  std::erase_if(classes, [](const RayClass& c) { return c.rays.empty(); });
  return classes;
}

std::vector<BuildRun> bench_build(const BuildOptions& options, const Progress<BuildRun>& progress) {
  static const std::vector<std::string> kDefault = {"boxes", "spheres", "balls", "rings", "displaced"};
  return run_each(options.scenes.empty() ? kDefault : options.scenes, progress,
                  [&](const std::string& name) { return BuildScene(options, name).run(progress.working); });
}

std::size_t count_not_identical(std::span<const BuildRun> runs) {
  return count_over(runs, [](const BuildRun& run) {
    return count_over(run.builders, [](const BuilderResult& b) {
      return count_over(b.traces, [&](const TraceTimes& t) { return b.tree ? t.n_not_identical : 0; });
    });
  });
}

}  // namespace kdray::bench
