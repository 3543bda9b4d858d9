#include "device/platform.h"
#include "kdray/kdray.h"

namespace kdray {

std::vector<DeviceInfo> devices() {
  std::vector<DeviceInfo> infos;
  for (const device::FoundDevice& found : device::find_devices()) infos.push_back(found.info);
  return infos;
}

}  // namespace kdray
