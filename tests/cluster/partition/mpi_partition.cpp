// One process of a scene that is divided among ranks, for measuring how much memory it takes: argument 1 is
// the scene, argument 2 "whole" for one process that has all of it.
#include <sys/resource.h>

#include <cstdio>
#include <string_view>

#include "cluster/partition/scene_partition.h"
#include "cluster/transport/mpi.h"
#include "scene/import/load.h"

namespace {

long peak_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss >> 10;
}

void tell(int rank, const kdray::prepare::Prepared& p) {
  std::printf("rank %d: %zu triangles, %zu MiB of geometry, peak %ld MiB, load %.2f s, build %.2f s\n", rank,
              p.flat.triangles.size(), p.bytes() >> 20, peak_mib(), p.seconds.load, p.seconds.build);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace kdray;
  if (argc < 2) return 2;
  try {
    if (argc > 2 && std::string_view(argv[2]) == "whole") {
      TreeOptions options;
      options.binary_form = false;
      tell(0, prepare::prepare(scene::load(argv[1]), options));
      return 0;
    }
    transport::Ranks ranks(transport::open_mpi(transport::launched().ranks));
    std::printf("rank %d: %ld MiB before\n", ranks.rank(), peak_mib());
    transport::Together all(ranks);
    const partition::ScenePartition own = partition::partition_scene(argv[1], {}, {}, all).value();
    tell(all.rank(), own.prepared);
    // The end may overtake what rank 0 has sent before.
    constexpr transport::Tags kDone = transport::kTagsOfFrames;
    if (!all.leads()) ranks.send(0, kDone.first, {});
    if (!all.leads()) return ranks.wait_for_end(nullptr);
    for (int n = 1; n < ranks.size(); ++n) ranks.wait(kDone);
    ranks.end(0);
    return 0;
  } catch (const std::exception& error) {
    std::printf("failed: %s\n", error.what());
    return 1;
  }
}
