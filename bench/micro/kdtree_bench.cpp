// What    Building the kd-tree over a displaced sphere, clipped and boxed. Units: triangles/s of wall time;
//         counters: references per triangle and expected SAH cost.
#include <benchmark/benchmark.h>

#include "accel/kdtree/build.h"
#include "accel/kdtree/statistics.h"
#include "scene/generate/displaced_sphere.h"
#include "scene/model/geometry.h"

namespace kdray {
namespace {

void build_tree(benchmark::State& state, bool clip) {
  const scene::Geometry geometry =
      scene::make_geometry(generate::displaced_sphere(static_cast<std::uint32_t>(state.range(0))));
  kdtree::BuildConfig config;
  config.clip = clip;
  kdtree::Tree tree;
  for (auto _ : state) tree = kdtree::build(geometry, config);
  const kdtree::Statistics statistics = kdtree::measure(tree, geometry, config);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(geometry.triangles.size()));
  state.counters["duplication"] = statistics.duplication;
  state.counters["sah_cost"] = statistics.sah_cost;
}
BENCHMARK_CAPTURE(build_tree, clipped, true)
    ->Arg(70)
    ->Arg(224)
    ->Arg(707)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(build_tree, boxed, false)
    ->Arg(70)
    ->Arg(224)
    ->Arg(707)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace kdray
