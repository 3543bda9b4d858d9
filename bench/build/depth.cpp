#include "bench/build/depth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "accel/prepare/prepared.h"
#include "bench/build/tree_facts.h"
#include "bench/race/compare_hits.h"
#include "bench/workload/rays.h"
#include "bench/workload/scenes.h"

namespace kdray::bench {

namespace {

constexpr int kDeepest = 64;

struct Measured {
  std::vector<BuildTimes> builds;
  std::vector<double> traces;
};

class DepthScene {
 public:
  DepthScene(const DepthOptions& options, const std::string& name)
      : options_(options), name_(name), scene_(load_scene(name)), geometry_(scene::make_geometry(scene_)) {
    if (geometry_.size() == 0)
      throw Error(ErrorCode::input, name + ": nothing to build a tree of; the scene is empty");
  }

  DepthRun run() {
    Renderer usual(PreparedScene(prepare_with(-1)), device());
    make_rays(usual);
    DepthRun run{name_,
                 usual.statistics().device.name,
                 geometry_.size(),
                 kdtree::depth_limit(kdtree::BuildConfig{}, geometry_.size()),
                 {}};
    for (const int depth : depths_to_try(run.usual_depth)) run.rows.push_back({depth, {}, {}, {}, 0});
    std::vector<Measured> measured(run.rows.size());
    for (int round = -1; round < options_.repeat; ++round)
      for (std::size_t i = 0; i < run.rows.size(); ++i) measure(run.rows[i], round >= 0, measured[i]);
    for (std::size_t i = 0; i < run.rows.size(); ++i) {
      run.rows[i].seconds = spreads_of(measured[i].builds);
      if (!measured[i].traces.empty()) run.rows[i].trace_seconds = spread_of(measured[i].traces);
    }
    return run;
  }

 private:
  kdtree::BuildConfig config(int depth) const {
    return prepare::config_of({.quality = options_.quality, .max_depth = depth, .binary_form = false},
                              geometry_.size());
  }
  prepare::Prepared prepare_with(int depth) const {
    return prepare::prepare(scene_, geometry_, config(depth));
  }

  void make_rays(Renderer& usual) {
    const int side = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(options_.rays))));
    classes_ = make_classes(scene_, build_classes(), side,
                            [&](std::span<const Ray> rays) { return usual.trace(rays); });
    std::erase_if(classes_, [](const RayClass& c) { return c.rays.empty(); });
    for (const RayClass& c : classes_) hits_.push_back(usual.trace(c.rays, c.any_hit, 1, Traversal::binary));
  }

  // Measures one round of a depth; the first warms up and is not counted.
  void measure(DepthRow& row, bool counts, Measured& measured) const {
    const BuildTimes times = time_build(scene_, geometry_, config(row.max_depth));
    if (counts) measured.builds.push_back(times);
    prepare::Prepared made = prepare_with(row.max_depth);
    row.tree = facts_of(made);
    if (row.tree.tight_cost > kDearest) return;
    const double seconds = trace(std::move(made), row);
    if (counts) measured.traces.push_back(seconds);
  }

  // Seconds for a million rays of each class.
  double trace(prepare::Prepared&& made, DepthRow& row) const {
    Renderer renderer(PreparedScene(std::move(made)), device());
    double seconds = 0;
    for (std::size_t i = 0; i < classes_.size(); ++i) {
      const RayClass& c = classes_[i];
      const std::vector<Hit> hits = renderer.trace(c.rays, c.any_hit);
      row.n_not_identical = std::max(row.n_not_identical, count_not_identical(hits_[i], hits));
      const double taken = renderer.statistics().seconds.trace;
      seconds += 1e6 * taken / static_cast<double>(c.rays.size());
    }
    return seconds;
  }

  DeviceOptions device() const { return {.device = options_.device}; }

  const DepthOptions& options_;
  std::string name_;
  scene::Scene scene_;
  scene::Geometry geometry_;
  std::vector<RayClass> classes_;
  std::vector<std::vector<Hit>> hits_;
};

}  // namespace

std::vector<int> depths_to_try(int usual) {
  std::vector<int> depths;
  for (int depth = 0; depth < usual; depth += 2) depths.push_back(depth);
  for (const int depth : {usual, usual + 4, usual + 8})
    if (depth <= kDeepest) depths.push_back(depth);
  return depths;
}

std::vector<DepthRun> bench_depth(const DepthOptions& options,
                                  const std::function<void(const DepthRun&)>& done,
                                  const std::function<void(const std::string&)>& working) {
  std::vector<DepthRun> runs;
  for (const std::string& name : options.scenes) {
    working(name);
    runs.push_back(DepthScene(options, name).run());
    done(runs.back());
  }
  return runs;
}

std::size_t count_not_identical(std::span<const DepthRun> runs) {
  std::size_t n = 0;
  for (const DepthRun& run : runs)
    for (const DepthRow& row : run.rows) n += row.n_not_identical;
  return n;
}

}  // namespace kdray::bench
