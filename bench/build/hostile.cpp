#include "bench/build/hostile.h"

#include <algorithm>
#include <array>

#include "accel/prepare/prepared.h"
#include "scene/generate/displaced_sphere.h"
#include "scene/generate/hostile_meshes.h"

namespace kdray::bench {

namespace {

class Mesh {
 public:
  Mesh(scene::Scene&& scene, BuildQuality quality)
      : scene_(std::move(scene)),
        geometry_(scene::make_geometry(scene_)),
        config_(prepare::config_of({.quality = quality, .binary_form = false}, geometry_.size())) {}

  BuildTimes build() const { return time_build(scene_, geometry_, config_); }
  prepare::Prepared prepared() const { return prepare::prepare(scene_, geometry_, config_); }
  std::size_t size() const { return geometry_.size(); }

 private:
  scene::Scene scene_;
  scene::Geometry geometry_;
  kdtree::BuildConfig config_;
};

HostileResult race_mesh(const generate::HostileMesh& hostile, const Mesh& plain,
                        const prepare::Prepared& plain_made, const HostileOptions& o) {
  const Mesh mesh(hostile.make(static_cast<std::uint32_t>(o.triangles)), o.quality);
  HostileResult r;
  r.mesh = hostile.name, r.what = hostile.what;
  r.n_triangles = mesh.size(), r.n_plain_triangles = plain.size();
  {
    const prepare::Prepared made = mesh.prepared();
    r.duplication = made.tree.duplication;
    r.wide_bytes = made.wide.bytes();
    r.tight_cost = made.tree.tight_cost;
    r.largest_leaf = made.tree.largest_leaf;
    r.max_depth = made.tree.max_depth;
  }
  r.plain_duplication = plain_made.tree.duplication;
  r.plain_tight_cost = plain_made.tree.tight_cost;
  r.plain_wide_bytes = plain_made.wide.bytes();
  const std::array<TimedBuild, 2> builds = {[&] { return plain.build(); }, [&] { return mesh.build(); }};
  const std::vector<BuildSpreads> seconds = race_builds(builds, o.repeat);
  r.plain_seconds = seconds[0], r.seconds = seconds[1];
  return r;
}

bool is_wanted(std::string_view name, const std::vector<std::string>& wanted) {
  return wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end();
}

}  // namespace

std::vector<HostileResult> bench_hostile(const HostileOptions& options,
                                         const std::function<void(const HostileResult&)>& done,
                                         const std::function<void(const std::string&)>& working) {
  const Mesh plain(generate::displaced_sphere_of(static_cast<std::size_t>(options.triangles)),
                   options.quality);
  const prepare::Prepared plain_made = plain.prepared();
  std::vector<HostileResult> results;
  for (const generate::HostileMesh& hostile : generate::hostile_meshes()) {
    if (!is_wanted(hostile.name, options.meshes)) continue;
    working(std::string(hostile.name));
    results.push_back(race_mesh(hostile, plain, plain_made, options));
    done(results.back());
  }
  return results;
}

}  // namespace kdray::bench
