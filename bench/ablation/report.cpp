#include "bench/ablation/bench.h"

#include <fmt/format.h>

namespace kdray::bench {

namespace {

std::string picture_words(const AblationRow& row) {
  if (row.n_differing == 0) return "same bits";
  return fmt::format("{} values, by {:.2g}{}", row.n_differing, row.largest_difference,
                     row.ablation.exact ? " (!)" : "");
}

Json json_of(const AblationRow& row) {
  return {{"without", row.ablation.name},
          {"kind", name_of(row.ablation.kind)},
          {"exact", row.ablation.exact},
          {"seconds", json_of(row.seconds)},
          {"ratio", json_of(row.ratio)},
          {"compile_seconds", json_if(row.compile_seconds)},
          {"rays", row.rays},
          {"differing_values", row.n_differing},
          {"largest_difference", row.largest_difference}};
}

Json json_of(const AblationRun& run) {
  return {{"scene", run.scene},
          {"device", run.device},
          {"primitives", run.n_primitives},
          {"features", {{"on", run.on}, {"off", run.off}}},
          {"rows", json_list(run.rows, [](const AblationRow& row) { return json_of(row); })}};
}

}  // namespace

std::string table_of(const AblationRun& run) {
  std::string out =
      fmt::format("{}: {} primitives\n  {:<40}{:>10}{:>9}{:>11}{:>11}  {}\n", short_name(run.scene),
                  run.n_primitives, "without", "ms", "x", "M rays", "compile s", "picture");
  for (const AblationRow& row : run.rows)
    out += fmt::format("  {:<40}{:>10.2f}{:>9.3f}{:>11.3f}{:>11}  {}\n", row.ablation.name,
                       1e3 * row.seconds.median, row.ratio.median, millions(row.rays.at("total")),
                       row.compile_seconds ? fmt::format("{:.2f}", *row.compile_seconds) : "-",
                       picture_words(row));
  return out;
}

Json json_of(std::span<const AblationRun> runs, const AblationOptions& options) {
  return {{"command", "bench ablation"},
          {"size", {options.width, options.height}},
          {"depth", options.depth},
          {"repeat", options.repeat},
          {"inexact", count_inexact(runs)},
          {"runs", json_list(runs, [](const AblationRun& run) { return json_of(run); })}};
}

}  // namespace kdray::bench
