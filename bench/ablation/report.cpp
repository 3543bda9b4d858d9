#include "bench/ablation/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/measure/short_name.h"

namespace kdray::bench {

namespace {

double millions(std::uint64_t n) {
  return 1e-6 * static_cast<double>(n);
}

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
          {"compile_seconds", row.compile_seconds ? Json(*row.compile_seconds) : Json()},
          {"rays", row.rays},
          {"differing_values", row.n_differing},
          {"largest_difference", row.largest_difference}};
}

Json json_of(const AblationRun& run) {
  Json json = {{"scene", run.scene},
               {"device", run.device},
               {"primitives", run.n_primitives},
               {"features", {{"on", run.on}, {"off", run.off}}},
               {"rows", Json::array()}};
  for (const AblationRow& row : run.rows) json["rows"].push_back(json_of(row));
  return json;
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
  Json json = {{"command", "bench ablation"},    {"size", {options.width, options.height}},
               {"depth", options.depth},         {"repeat", options.repeat},
               {"inexact", count_inexact(runs)}, {"runs", Json::array()}};
  for (const AblationRun& run : runs) json["runs"].push_back(json_of(run));
  return json;
}

}  // namespace kdray::bench
