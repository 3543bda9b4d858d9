#include <fmt/format.h>

#include "bench/build/report.h"

namespace kdray::bench {

namespace {

std::string row(const std::string& name, std::size_t n, const BuildSpreads& s, double duplication,
                std::size_t wide_bytes, double cost) {
  return fmt::format(
      "  {:<12}{:>10}{:>9.1f}{:>9.1f}{:>9.1f} {:>9.1f}-{:<9.1f}{:>9.1f}{:>9.2f}{:>9.1f}{:>10.4g}", name, n,
      1e3 * s.tree.median, 1e3 * s.flatten.median, 1e3 * s.total.median, 1e3 * s.total.min, 1e3 * s.total.max,
      1e3 * s.cpu.median, duplication, static_cast<double>(wide_bytes) * 1e-6, cost);
}

double cpu_times_plain(const HostileResult& r) {
  return r.seconds.cpu.median / r.plain_seconds.cpu.median;
}

}  // namespace

std::string hostile_heading() {
  return fmt::format("  {:<12}{:>10}{:>9}{:>9}{:>9} {:^19}{:>9}{:>9}{:>9}{:>10}{:>8}{:>8}{:>7}{:>8}",
                     "milliseconds", "triangles", "tree", "flatten", "both", "min-max", "cpu", "refs/tri",
                     "wide MB", "cost", "x time", "x cpu", "depth", "leaf");
}

std::string table_of(const HostileResult& r) {
  return row(r.mesh, r.n_triangles, r.seconds, r.duplication, r.wide_bytes, r.tight_cost) +
         fmt::format("{:>8.2f}{:>8.2f}{:>7}{:>8}\n", r.times_plain(), cpu_times_plain(r), r.max_depth,
                     r.largest_leaf) +
         row("  (plain)", r.n_plain_triangles, r.plain_seconds, r.plain_duplication, r.plain_wide_bytes,
             r.plain_tight_cost);
}

Json json_of(std::span<const HostileResult> results, const HostileOptions& options) {
  Json json = {{"command", "bench build --hostile"},
               {"triangles", options.triangles},
               {"repeat", options.repeat},
               {"meshes", Json::array()}};
  for (const HostileResult& r : results)
    json["meshes"].push_back({{"mesh", r.mesh},
                              {"what", r.what},
                              {"triangles", r.n_triangles},
                              {"seconds", json_of(r.seconds)},
                              {"plain_seconds", json_of(r.plain_seconds)},
                              {"times_plain", r.times_plain()},
                              {"cpu_times_plain", cpu_times_plain(r)},
                              {"duplication", r.duplication},
                              {"plain_duplication", r.plain_duplication},
                              {"wide_bytes", r.wide_bytes},
                              {"plain_wide_bytes", r.plain_wide_bytes},
                              {"tight_cost", r.tight_cost},
                              {"plain_tight_cost", r.plain_tight_cost},
                              {"largest_leaf", r.largest_leaf},
                              {"max_depth", r.max_depth}});
  return json;
}

}  // namespace kdray::bench
