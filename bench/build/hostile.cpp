// What    bench build --hostile, and its report.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "bench/build/bench.h"
#include "scene/generate/displaced_sphere.h"
#include "scene/generate/hostile_meshes.h"

namespace kdray::bench {

namespace {

struct Mesh {
  Mesh(scene::Scene&& scene, BuildQuality quality)
      : input(std::move(scene)),
        config(prepare::config_of({.quality = quality, .binary_form = false}, input.geometry.size())),
        built{.n_triangles = input.geometry.size(),
              .tree = facts_of(prepare::prepare(input.scene, input.geometry, config))} {}

  BuildTimes build() const { return time_build(input.scene, input.geometry, config); }

  BuildInput input;
  kdtree::BuildConfig config;
  BuiltMesh built;
};

HostileResult race_mesh(const generate::HostileMesh& hostile, const Mesh& plain, const HostileOptions& o) {
  const Mesh mesh(hostile.make(static_cast<std::uint32_t>(o.triangles)), o.quality);
  HostileResult r{std::string(hostile.name), std::string(hostile.what), mesh.built, plain.built};
  const std::array<TimedBuild, 2> builds = {[&] { return plain.build(); }, [&] { return mesh.build(); }};
  const std::vector<BuildSpreads> seconds = race_builds(builds, o.repeat);
  r.plain.seconds = seconds[0], r.hostile.seconds = seconds[1];
  return r;
}

std::string row(const std::string& name, const BuiltMesh& m) {
  return fmt::format("  {:<12}{:>10}{}{:>9.2f}{:>9.1f}{:>10.4g}", name, m.n_triangles, times_cells(m.seconds),
                     m.tree.duplication, millions(m.tree.wide_bytes), m.tree.tight_cost);
}

}  // namespace

std::vector<HostileResult> bench_hostile(const HostileOptions& options,
                                         const Progress<HostileResult>& progress) {
  const Mesh plain(generate::displaced_sphere_of(static_cast<std::size_t>(options.triangles)),
                   options.quality);
  std::vector<generate::HostileMesh> wanted;
  for (const generate::HostileMesh& mesh : generate::hostile_meshes())
    if (options.meshes.empty() || std::ranges::find(options.meshes, mesh.name) != options.meshes.end())
      wanted.push_back(mesh);
  return run_each(wanted, progress, [&](const generate::HostileMesh& mesh) {
    progress.working(std::string(mesh.name));
    return race_mesh(mesh, plain, options);
  });
}

std::string hostile_heading() {
  return fmt::format("  {:<12}{:>10}{}{:>9}{:>9}{:>10}{:>8}{:>8}{:>7}{:>8}", "milliseconds", "triangles",
                     times_heading(), "refs/tri", "wide MB", "cost", "x time", "x cpu", "depth", "leaf");
}

std::string table_of(const HostileResult& r) {
  return row(r.mesh, r.hostile) +
         fmt::format("{:>8.2f}{:>8.2f}{:>7}{:>8}\n", r.times_plain(), r.cpu_times_plain(),
                     r.hostile.tree.max_depth, r.hostile.tree.largest_leaf) +
         row("  (plain)", r.plain);
}

Json json_of(std::span<const HostileResult> results, const HostileOptions& options) {
  const auto mesh = [](const HostileResult& r) -> Json {
    return {{"mesh", r.mesh},
            {"what", r.what},
            {"triangles", r.hostile.n_triangles},
            {"seconds", json_of(r.hostile.seconds)},
            {"plain_seconds", json_of(r.plain.seconds)},
            {"times_plain", r.times_plain()},
            {"cpu_times_plain", r.cpu_times_plain()},
            {"duplication", r.hostile.tree.duplication},
            {"plain_duplication", r.plain.tree.duplication},
            {"wide_bytes", r.hostile.tree.wide_bytes},
            {"plain_wide_bytes", r.plain.tree.wide_bytes},
            {"tight_cost", r.hostile.tree.tight_cost},
            {"plain_tight_cost", r.plain.tree.tight_cost},
            {"largest_leaf", r.hostile.tree.largest_leaf},
            {"max_depth", r.hostile.tree.max_depth}};
  };
  return {{"command", "bench build --hostile"},
          {"triangles", options.triangles},
          {"repeat", options.repeat},
          {"meshes", json_list(results, mesh)}};
}

}  // namespace kdray::bench
