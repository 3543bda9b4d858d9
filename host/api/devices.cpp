#include "device/context.h"
#include "kdray/kdray.h"

namespace kdray {

namespace {

// What only an opened device can tell: the form of its vectors, and whether it computes rightly at all.
DeviceInfo opened(const DeviceInfo& listed) {
  if (!listed.usable) return listed;
  try {
    return device::Context(std::to_string(listed.number), 1).info();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::no_device) throw;
    DeviceInfo info = listed;
    info.usable = false;
    info.why_not = error.what();
    return info;
  }
}

}  // namespace

std::vector<DeviceInfo> devices() {
  std::vector<DeviceInfo> infos;
  for (const device::FoundDevice& found : device::find_devices()) infos.push_back(opened(found.info));
  return infos;
}

}  // namespace kdray
