// What    Tracing random rays through a displaced sphere on the default device. Units: rays/s, rays and scene
//         already on the device (Renderer's own timing); the hits are checked against a count before anything
//         is timed.
#include <benchmark/benchmark.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "kdray/kdray.h"
#include "scene/generate/displaced_sphere.h"

namespace kdray {
namespace {

std::vector<Ray> rays_from_inside(std::size_t n) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::vector<Ray> rays(n);
  for (Ray& r : rays)
    r = {{0.1f * normal(random), 0.1f * normal(random), 0.1f * normal(random)},
         0,
         {normal(random), normal(random), normal(random)},
         std::numeric_limits<float>::infinity()};
  return rays;
}

void trace(benchmark::State& state, bool any_hit) {
  Renderer renderer{Scene(generate::displaced_sphere(static_cast<std::uint32_t>(state.range(0))))};
  const std::vector<Ray> rays = rays_from_inside(1 << 20);
  for (const Hit& hit : renderer.trace(rays))
    if (hit.primitive < 0) state.SkipWithError("a ray escaped from a closed mesh");
  for (auto _ : state) {
    (void)renderer.trace(rays, any_hit);
    state.SetIterationTime(renderer.statistics().seconds.trace);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rays.size()));
}
BENCHMARK_CAPTURE(trace, closest, false)->Arg(100)->Arg(700)->Unit(benchmark::kMillisecond)->UseManualTime();
BENCHMARK_CAPTURE(trace, any, true)->Arg(100)->Arg(700)->Unit(benchmark::kMillisecond)->UseManualTime();

}  // namespace
}  // namespace kdray
