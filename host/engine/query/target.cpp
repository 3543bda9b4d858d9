#include "engine/query/target.h"

namespace kdray::query {

std::vector<Target> targets_of(engine::DeviceScene& devices, Traversal traversal, Precision precision) {
  std::vector<Target> targets;
  for (engine::Device& device : devices)
    for (std::size_t part = 0; part < device.context.n_sub_devices(); ++part) {
      Target& target = targets.emplace_back(Target{device.context, device.buffers(), device.programs,
                                                   devices.scene(), device.work_group, device.global});
      target.sub_device = part;
      target.traversal = traversal;
      target.precision = precision;
    }
  return targets;
}

}  // namespace kdray::query
