#include "api/open_devices.h"
#include "device/context.h"
#include "kdray/kdray.h"

namespace kdray {

namespace {

// Adds what only an opened device can tell: the form of its vectors, and whether it computes rightly at all.
DeviceInfo opened(const DeviceInfo& listed, const DeviceOptions& options) {
  if (!listed.usable) return listed;
  try {
    DeviceOptions one = options;
    one.device = std::to_string(listed.number);
    one.queues = 1;
    return api::open_devices(one).contexts.front().info();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::no_device) throw;
    DeviceInfo info = listed;
    info.usable = false;
    info.why_not = error.what();
    return info;
  }
}

}  // namespace

std::vector<DeviceInfo> devices(const DeviceOptions& options) {
  std::vector<DeviceInfo> infos;
  for (const device::FoundDevice& found : device::find_devices())
    infos.push_back(opened(found.info, options));
  return infos;
}

}  // namespace kdray
