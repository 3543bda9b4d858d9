#include <fmt/format.h>

#include <cmath>
#include <map>

#include "bench/build/report.h"
#include "bench/embree/embree.h"

namespace kdray::bench {

namespace {

double nanoseconds_each(const GrowthResult& result, const GrowthRow& row) {
  return 1e9 * row.seconds.total.median / static_cast<double>(result.n_triangles);
}

// How much longer each triangle takes than at the smallest size that was measured with this builder, for each
// doubling of their number.
double growth(std::span<const GrowthResult> results, const GrowthResult& result, const GrowthRow& row) {
  const auto each = [&](const GrowthResult& r, const GrowthRow& b) {
    return nanoseconds_each(r, b) / std::log2(static_cast<double>(r.n_triangles));
  };
  for (const GrowthResult& r : results)
    for (const GrowthRow& b : r.rows)
      if (b.builder == row.builder) return each(result, row) / each(r, b);
  return 1;
}

}  // namespace

std::string table_of(const GrowthResult& result) {
  std::string out =
      fmt::format("{} triangles\n  {:<15}{:>9}{:>9}{:>9} {:^17}{:>9}{:>9}{:>7}{:>9}\n", result.n_triangles,
                  "milliseconds", "tree", "flatten", "both", "min-max", "cpu", "ns each", "refs", "peak MB");
  for (const GrowthRow& row : result.rows) {
    const BuildSpreads& s = row.seconds;
    out += fmt::format("  {:<15}{:>9.1f}{:>9.1f}{:>9.1f} {:>8.1f}-{:<8.1f}{:>9.1f}{:>9.1f}", row.builder,
                       1e3 * s.tree.median, 1e3 * s.flatten.median, 1e3 * s.total.median, 1e3 * s.total.min,
                       1e3 * s.total.max, 1e3 * s.cpu.median, nanoseconds_each(result, row));
    out += row.duplication ? fmt::format("{:>7.2f}", *row.duplication) : fmt::format("{:>7}", "");
    out += row.peak_bytes ? fmt::format("{:>9.1f}\n", static_cast<double>(*row.peak_bytes) * 1e-6)
                          : fmt::format("{:>9}\n", "-");
  }
  return out;
}

Json json_of(std::span<const GrowthResult> results, const GrowthOptions& options) {
  const std::string embree = options.embree ? embree_versions() : "";
  Json json = {{"command", "bench build --growth"},
               {"embree", embree.empty() ? Json() : Json(embree)},
               {"repeat", options.repeat},
               {"sizes", Json::array()}};
  for (const GrowthResult& r : results) {
    Json size = {{"triangles", r.n_triangles}, {"builders", Json::array()}};
    for (const GrowthRow& row : r.rows)
      size["builders"].push_back({{"builder", row.builder},
                                  {"seconds", json_of(row.seconds)},
                                  {"nanoseconds_per_triangle", nanoseconds_each(r, row)},
                                  {"growth_over_n_log_n", growth(results, r, row)},
                                  {"duplication", row.duplication ? Json(*row.duplication) : Json()},
                                  {"peak_bytes", row.peak_bytes ? Json(*row.peak_bytes) : Json()}});
    json["sizes"].push_back(std::move(size));
  }
  return json;
}

}  // namespace kdray::bench
