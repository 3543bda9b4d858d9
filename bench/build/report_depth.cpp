#include <fmt/format.h>

#include "accel/prepare/prepared.h"
#include "bench/build/report.h"
#include "bench/measure/short_name.h"

namespace kdray::bench {

namespace {

Json json_of(const DepthRow& row) {
  return {{"max_depth", row.max_depth},
          {"seconds", json_of(row.seconds)},
          {"trace_seconds", row.trace_seconds ? json_of(*row.trace_seconds) : Json()},
          {"tree", json_of(row.tree)},
          {"not_identical", row.n_not_identical}};
}

Json json_of(const DepthRun& run) {
  Json json = {{"scene", run.scene},
               {"device", run.device},
               {"primitives", run.n_primitives},
               {"usual_depth", run.usual_depth},
               {"depths", Json::array()}};
  for (const DepthRow& row : run.rows) json["depths"].push_back(json_of(row));
  return json;
}

}  // namespace

std::string table_of(const DepthRun& run) {
  std::string out = fmt::format(
      "{}: {} primitives, usually {} deep\n  {:>5}{:>8}{:>10}{:>10}{:>9}{:>11}{:>11}{:>11}{:>11}{:>12}\n",
      short_name(run.scene), run.n_primitives, run.usual_depth, "depth", "reached", "build ms", "cpu ms",
      "refs", "binary MB", "wide MB", "SAH cost", "tight", "ms/3M rays");
  for (const DepthRow& row : run.rows) {
    out += fmt::format(
        "  {:>5}{:>8}{:>10.2f}{:>10.2f}{:>9.2f}{:>11.2f}{:>11.2f}{:>11.4g}{:>11.4g}", row.max_depth,
        row.tree.max_depth, 1e3 * row.seconds.total.median, 1e3 * row.seconds.cpu.median,
        row.tree.duplication, static_cast<double>(row.tree.binary_bytes) * 1e-6,
        static_cast<double>(row.tree.wide_bytes) * 1e-6, row.tree.sah_cost, row.tree.tight_cost);
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
  Json json = {
      {"command", "bench depth"}, {"build", prepare::name_of(options.quality)}, {"rays", options.rays},
      {"repeat", options.repeat}, {"not_identical", count_not_identical(runs)}, {"runs", Json::array()}};
  for (const DepthRun& run : runs) json["runs"].push_back(json_of(run));
  return json;
}

}  // namespace kdray::bench
