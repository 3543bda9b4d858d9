#include "bench/embree/build.h"
#include "bench/embree/embree.h"
#include "bench/embree/sides.h"

namespace kdray::bench {

class EmbreeScenes {};

std::string embree_version() {
  return "";
}

std::shared_ptr<EmbreeScenes> make_embree_scenes(const scene::Scene&) {
  return nullptr;
}

std::vector<Contestant> embree_contestants(const std::shared_ptr<EmbreeScenes>&, int) {
  return {};
}

TimedBuild embree_build(const scene::Scene&, const scene::Geometry&) {
  return {};
}

std::vector<Side> embree_sides(const MeshArrays&, int) {
  return {};
}

bool embree_answers(Question) {
  return false;
}

Traced trace_embree16(const std::shared_ptr<EmbreeScenes>&, const RayClass&, int) {
  return {};
}

}  // namespace kdray::bench
