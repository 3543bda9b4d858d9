// What    bench depth, and its report.
#include <fmt/format.h>

#include <algorithm>

#include "accel/prepare/prepared.h"
#include "bench/build/bench.h"
#include "bench/race/compare.h"

namespace kdray::bench {

namespace {

constexpr int kDeepest = 64;
constexpr double kDearest = 1000;  // expected cost, beyond which tracing would take minutes

struct Measured {
  std::vector<BuildTimes> builds;
  std::vector<double> traces;
};

class DepthScene {
 public:
  DepthScene(const DepthOptions& options, const std::string& name)
      : options_(options), name_(name), input_(name) {}

  DepthRun run() {
    Renderer usual(PreparedScene(prepare_with(-1)), device());
    make_rays(usual);
    DepthRun run{name_,
                 usual.statistics().device.name,
                 input_.geometry.size(),
                 kdtree::depth_limit(kdtree::BuildConfig{}, input_.geometry.size()),
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
                              input_.geometry.size());
  }
  prepare::Prepared prepare_with(int depth) const {
    return prepare::prepare(input_.scene, input_.geometry, config(depth));
  }

  void make_rays(Renderer& usual) {
    classes_ = build_rays(input_.scene, options_.rays, usual);
    for (const RayClass& c : classes_) hits_.push_back(usual.trace(c.rays, c.any_hit, 1, Traversal::binary));
  }

  // Measures one round of a depth; the first warms up and is not counted.
  void measure(DepthRow& row, bool counts, Measured& measured) const {
    const BuildTimes times = time_build(input_.scene, input_.geometry, config(row.max_depth));
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
  BuildInput input_;
  std::vector<RayClass> classes_;
  std::vector<std::vector<Hit>> hits_;
};

Json json_of(const DepthRow& row) {
  return {{"max_depth", row.max_depth},
          {"seconds", json_of(row.seconds)},
          {"trace_seconds", json_if(row.trace_seconds)},
          {"tree", json_of(row.tree)},
          {"not_identical", row.n_not_identical}};
}

Json json_of(const DepthRun& run) {
  return {{"scene", run.scene},
          {"device", run.device},
          {"primitives", run.n_primitives},
          {"usual_depth", run.usual_depth},
          {"depths", json_list(run.rows, [](const DepthRow& row) { return json_of(row); })}};
}

}  // namespace

std::vector<int> depths_to_try(int usual) {
  std::vector<int> depths;
  for (int depth = 0; depth < usual; depth += 2) depths.push_back(depth);
  for (const int depth : {usual, usual + 4, usual + 8})
    if (depth <= kDeepest) depths.push_back(depth);
  return depths;
}

std::vector<DepthRun> bench_depth(const DepthOptions& options, const Progress<DepthRun>& progress) {
  return run_scenes<DepthScene>(options, progress);
}

std::size_t count_not_identical(std::span<const DepthRun> runs) {
  return count_over(runs, [](const DepthRun& run) {
    return count_over(run.rows, [](const DepthRow& row) { return row.n_not_identical; });
  });
}

std::string table_of(const DepthRun& run) {
  std::string out = fmt::format(
      "{}: {} primitives, usually {} deep\n  {:>5}{:>8}{:>10}{:>10}{:>9}{:>11}{:>11}{:>11}{:>11}{:>12}\n",
      short_name(run.scene), run.n_primitives, run.usual_depth, "depth", "reached", "build ms", "cpu ms",
      "refs", "binary MB", "wide MB", "SAH cost", "tight", "ms/3M rays");
  for (const DepthRow& row : run.rows) {
    out += fmt::format("  {:>5}{:>8}{:>10.2f}{:>10.2f}{:>9.2f}{:>11.2f}{:>11.2f}{:>11.4g}{:>11.4g}",
                       row.max_depth, row.tree.max_depth, 1e3 * row.seconds.total.median,
                       1e3 * row.seconds.cpu.median, row.tree.duplication, millions(row.tree.binary_bytes),
                       millions(row.tree.wide_bytes), row.tree.sah_cost, row.tree.tight_cost);
    out += row.trace_seconds ? fmt::format("{:>12.1f}\n", 1e3 * row.trace_seconds->median)
                             : fmt::format("{:>12}\n", "-");
  }
  for (const DepthRow& row : run.rows)
    if (row.n_not_identical > 0)
      out += fmt::format("  depth {}: {} hits are not those of the usual depth\n", row.max_depth,
                         row.n_not_identical);
  return out;
}

Json json_of(std::span<const DepthRun> runs, const DepthOptions& options) {
  return {{"command", "bench depth"},
          {"build", prepare::name_of(options.quality)},
          {"rays", options.rays},
          {"repeat", options.repeat},
          {"not_identical", count_not_identical(runs)},
          {"runs", json_list(runs, [](const DepthRun& run) { return json_of(run); })}};
}

}  // namespace kdray::bench
