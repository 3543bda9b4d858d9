#include "engine/query/device_scene.h"

#include <algorithm>

namespace kdray::test {

DeviceScene::DeviceScene(const scene::Scene& scene, const std::string& device,
                         const std::string& build_options, const TreeOptions& tree)
    : prepared_(prepare::prepare(scene, tree)),
      context_(device, 1),
      buffers_(context_, prepared_.flat, prepared_.wide),
      programs_(context_, prepared_.tree_depth, prepared_.wide, build_options),
      is_cpu_(context_.info().kind == "cpu"),
      work_group_(std::min<std::size_t>(is_cpu_ ? 16 : 64, context_.max_work_group())) {
  programs_.query_alone(true);  // on CPUs too
}

}  // namespace kdray::test
