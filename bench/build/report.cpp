#include <fmt/format.h>

#include <optional>

#include "bench/build/bench.h"
#include "bench/embree/embree.h"

namespace kdray::bench {

namespace {

std::string heading(const BuildRun& run) {
  return fmt::format("{}: {}, {}\n", short_name(run.scene), in_words(run.n_primitives),
                     counted(run.machine.cores, "core"));
}

std::string columns(const BuildRun& run) {
  std::string out = fmt::format("  {:<15}{}{:>8}{:>8}{:>8}{:>8}{:>10}{:>9}", "milliseconds", times_heading(),
                                "/Embree", "cpu/E", "refs", "cost", "binary MB", "wide MB");
  if (!run.builders.empty())
    for (const TraceTimes& t : run.builders.front().traces) out += fmt::format("{:>9}", t.ray_class);
  return out + "\n";
}

// How many times as long kdray takes as Embree, by medians.
struct BuildRatios {
  double wall, cpu;
};

std::optional<BuildRatios> ratios_to(const BuilderResult* embree, const BuilderResult& b) {
  if (embree == nullptr) return std::nullopt;
  return BuildRatios{b.seconds.total.median / embree->seconds.total.median,
                     b.seconds.cpu.median / embree->seconds.cpu.median};
}

std::string row(const BuilderResult& b, const std::optional<BuildRatios>& ratios) {
  std::string out = fmt::format("  {:<15}{}", b.builder, times_cells(b.seconds));
  out += ratios ? fmt::format("{:>8.2f}{:>8.2f}", ratios->wall, ratios->cpu) : fmt::format("{:>16}", "");
  out += b.tree ? fmt::format("{:>8.2f}{:>8.2f}{:>10.1f}{:>9.1f}", b.tree->duplication, b.tree->tight_cost,
                              millions(b.tree->binary_bytes), millions(b.tree->wide_bytes))
                : fmt::format("{:>35}", "");
  for (const TraceTimes& t : b.traces)
    out += fmt::format("{:>9.2f}", mrays_per_s(t.n_rays, t.seconds).median);
  return out + "\n";
}

std::string disagreements(const BuildRun& run) {
  std::string out;
  for (const BuilderResult& b : run.builders)
    for (const TraceTimes& t : b.traces)
      if (b.tree && t.n_not_identical > 0)
        out += fmt::format("  {}: {} of {} hits over the tree of {} are not those over the balanced one\n",
                           t.ray_class, t.n_not_identical, t.n_rays, b.builder);
  return out;
}

Json json_of(const BuilderResult& b, const std::optional<BuildRatios>& ratios) {
  const auto trace = [&](const TraceTimes& t) {
    Json json = {{"class", t.ray_class},
                 {"rays", t.n_rays},
                 {"seconds", json_of(t.seconds)},
                 {"mrays_per_s", json_of(mrays_per_s(t.n_rays, t.seconds))}};
    if (b.tree) json["not_identical"] = t.n_not_identical;
    return json;
  };
  return {{"builder", b.builder},
          {"seconds", json_of(b.seconds)},
          {"times_embree", ratios ? Json(ratios->wall) : Json()},
          {"cpu_times_embree", ratios ? Json(ratios->cpu) : Json()},
          {"tree", b.tree ? json_of(*b.tree) : Json()},
          {"trace_seconds", b.trace_seconds()},
          {"traces", json_list(b.traces, trace)}};
}

Json json_of(const BuildRun& run) {
  const auto builder = [&](const BuilderResult& b) { return json_of(b, ratios_to(run.embree(), b)); };
  return {{"scene", run.scene},
          {"primitives", json_of(run.n_primitives)},
          {"cores", run.machine.cores},
          {"device", run.machine.device},
          {"vectors", run.machine.vectors},
          {"builders", json_list(run.builders, builder)}};
}

}  // namespace

std::string table_of(const BuildRun& run) {
  std::string out = heading(run) + columns(run);
  for (const BuilderResult& b : run.builders) out += row(b, ratios_to(run.embree(), b));
  return out + "  (the last columns: Mrays/s of each class)\n" + disagreements(run);
}

Json json_of(std::span<const BuildRun> runs, const BuildOptions& options) {
  return {{"command", "bench build"},
          {"embree", embree_json(options.embree)},
          {"rays", options.rays},
          {"repeat", options.repeat},
          {"not_identical", count_not_identical(runs)},
          {"runs", json_list(runs, [](const BuildRun& run) { return json_of(run); })}};
}

}  // namespace kdray::bench
