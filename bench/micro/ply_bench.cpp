// What    Reading a binary PLY from memory. Units: triangles/s and bytes/s.
#include <benchmark/benchmark.h>

#include <string>

#include "scene/generate/displaced_sphere.h"
#include "scene/import/load.h"

namespace kdray {
namespace {

template <class T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string binary_ply(const scene::Scene& s) {
  std::string out =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(s.vertices.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
      std::to_string(s.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const dvec3& v : s.vertices)
    for (int k = 0; k < 3; ++k) put(out, static_cast<float>(v[k]));
  for (const scene::Triangle& t : s.triangles) {
    put(out, std::uint8_t{3});
    for (const std::uint32_t v : t.vertex) put(out, static_cast<std::int32_t>(v));
  }
  return out;
}

void read_binary_ply(benchmark::State& state) {
  const scene::Scene mesh = generate::displaced_sphere(static_cast<std::uint32_t>(state.range(0)));
  const std::string ply = binary_ply(mesh);
  for (auto _ : state) {
    const scene::Scene read = scene::read_ply(ply, "bench.ply");
    if (read.triangles.size() != mesh.triangles.size()) state.SkipWithError("triangles are missing");
    benchmark::DoNotOptimize(read.triangles.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(mesh.triangles.size()));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(ply.size()));
}
BENCHMARK(read_binary_ply)->Arg(100)->Arg(700)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace kdray
