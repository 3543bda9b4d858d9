// What    Builds by Embree, for the clock (embree.h).
#include <fmt/format.h>

#include "bench/embree/embree.h"
#include "bench/embree/scenes.h"

namespace kdray::bench {

namespace {

BuildTimes build(const std::shared_ptr<embree::OpenDevice>& device, const embree::KindBuffers& buffers) {
  embree::OwnedScene made(device, false);
  made.add(buffers);
  const Stopwatch clock;
  made.commit();
  return {clock.wall(), 0, clock.cpu()};
}

}  // namespace

std::vector<EmbreeBuild> embree_builds(const scene::Scene& scene, const scene::Geometry& geometry) {
  if (embree::libraries().empty()) return {};
  const auto buffers = std::make_shared<embree::KindBuffers>(embree::buffers_of(scene, geometry));
  std::vector<EmbreeBuild> builds;
  for (const embree::Library& library : embree::libraries())
    builds.push_back({fmt::format("Embree {} medium", library.major),
                      [buffers, device = std::make_shared<embree::OpenDevice>(library)] {
                        return build(device, *buffers);
                      }});
  return builds;
}

}  // namespace kdray::bench
