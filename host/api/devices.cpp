#include <algorithm>
#include <iterator>

#include "api/open_devices.h"
#include "device/opencl/context.h"
#include "kdray/kdray.h"
#include "probe/trial/devices.h"

namespace kdray {

namespace {

DeviceInfo unusable(DeviceInfo info, const std::string& why) {
  info.usable = false;
  info.why_not = why;
  return info;
}

// Adds what only an opened device can tell: the form of its vectors, and whether it computes rightly at all.
DeviceInfo opened(const DeviceInfo& listed, const DeviceOptions& options) {
  try {
    DeviceOptions one = options;
    one.device = std::to_string(listed.number);
    one.queues = 1;
    return api::open_devices(one).contexts.front().info();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::no_device) throw;
    return unusable(listed, error.what());
  }
}

}  // namespace

std::vector<DeviceInfo> devices(const DeviceOptions& options) {
  device::refuse_after_fork();
  for (const std::string& why : api::leave_out_drivers(options))
    if (options.left_out) options.left_out(why);
  std::vector<DeviceInfo> infos;
  const std::vector<device::FoundDevice> found = device::find_devices();
  std::vector<device::FoundDevice> usable;
  std::ranges::copy_if(found, std::back_inserter(usable), [](const auto& d) { return d.info.usable; });
  trial::DeviceTrials trials(api::verdicts_of(options), true, options.building);
  for (std::size_t i = 0, u = 0; i < found.size(); ++i) {
    const DeviceInfo& info = found[i].info;
    const std::string why = info.usable ? trials.why_not(usable, u++) : "";
    infos.push_back(!info.usable ? info : why.empty() ? opened(info, options) : unusable(info, why));
  }
  return infos;
}

}  // namespace kdray
