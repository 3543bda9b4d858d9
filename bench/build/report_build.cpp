#include <fmt/format.h>

#include <optional>

#include "bench/build/report.h"
#include "bench/embree/embree.h"
#include "bench/measure/short_name.h"

namespace kdray::bench {

namespace {

std::string heading(const BuildRun& run) {
  return fmt::format("{}: {}, {} core{}\n", short_name(run.scene), in_words(run.n_primitives), run.cores,
                     run.cores == 1 ? "" : "s");
}

std::string columns(const BuildRun& run) {
  std::string out = fmt::format("  {:<15}{:>9}{:>9}{:>9} {:^17}{:>9}{:>8}{:>8}{:>8}{:>8}{:>10}{:>9}",
                                "milliseconds", "tree", "flatten", "both", "min-max", "cpu", "/Embree",
                                "cpu/E", "refs", "cost", "binary MB", "wide MB");
  if (!run.builders.empty())
    for (const TraceTimes& t : run.builders.front().traces) out += fmt::format("{:>9}", t.ray_class);
  return out + "\n";
}

std::string megabytes(std::size_t bytes) {
  return fmt::format("{:>9.1f}", static_cast<double>(bytes) * 1e-6);
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
  const BuildSpreads& s = b.seconds;
  std::string out = fmt::format("  {:<15}{:>9.1f}{:>9.1f}{:>9.1f} {:>8.1f}-{:<8.1f}{:>9.1f}", b.builder,
                                1e3 * s.tree.median, 1e3 * s.flatten.median, 1e3 * s.total.median,
                                1e3 * s.total.min, 1e3 * s.total.max, 1e3 * s.cpu.median);
  out += ratios ? fmt::format("{:>8.2f}{:>8.2f}", ratios->wall, ratios->cpu) : fmt::format("{:>16}", "");
  out += b.tree ? fmt::format("{:>8.2f}{:>8.2f} ", b.tree->duplication, b.tree->tight_cost) +
                      megabytes(b.tree->binary_bytes) + megabytes(b.tree->wide_bytes)
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
  Json json = {{"builder", b.builder},
               {"seconds", json_of(b.seconds)},
               {"times_embree", ratios ? Json(ratios->wall) : Json()},
               {"cpu_times_embree", ratios ? Json(ratios->cpu) : Json()},
               {"tree", b.tree ? json_of(*b.tree) : Json()},
               {"trace_seconds", b.trace_seconds()},
               {"traces", Json::array()}};
  for (const TraceTimes& t : b.traces) {
    Json trace = {{"class", t.ray_class},
                  {"rays", t.n_rays},
                  {"seconds", json_of(t.seconds)},
                  {"mrays_per_s", json_of(mrays_per_s(t.n_rays, t.seconds))}};
    if (b.tree) trace["not_identical"] = t.n_not_identical;
    json["traces"].push_back(std::move(trace));
  }
  return json;
}

Json json_of(const BuildRun& run) {
  Json json = {{"scene", run.scene},
               {"primitives", json_of(run.n_primitives)},
               {"cores", run.cores},
               {"device", run.device},
               {"builders", Json::array()}};
  for (const BuilderResult& b : run.builders)
    json["builders"].push_back(json_of(b, ratios_to(run.embree(), b)));
  return json;
}

}  // namespace

std::string table_of(const BuildRun& run) {
  std::string out = heading(run) + columns(run);
  for (const BuilderResult& b : run.builders) out += row(b, ratios_to(run.embree(), b));
  return out + "  (the last columns: Mrays/s of each class)\n" + disagreements(run);
}

Json json_of(std::span<const BuildRun> runs, const BuildOptions& options) {
  const std::string embree = options.embree ? embree_versions() : "";
  Json json = {{"command", "bench build"},
               {"embree", embree.empty() ? Json() : Json(embree)},
               {"rays", options.rays},
               {"repeat", options.repeat},
               {"not_identical", count_not_identical(runs)},
               {"runs", Json::array()}};
  for (const BuildRun& run : runs) json["runs"].push_back(json_of(run));
  return json;
}

}  // namespace kdray::bench
