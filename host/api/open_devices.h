// What    Opens the devices that DeviceOptions names: each has passed the self-test, and keeps what it builds
//         in the folder that the options name.
#pragma once

#include <string>
#include <vector>

#include "device/context.h"
#include "kdray/kdray.h"

namespace kdray::api {

device::Builds builds_of(const DeviceOptions& options);

struct OpenedDevices {
  std::vector<device::Context> contexts;
  OpenSeconds seconds;
};

// `faults` as in Hooks. Throws ErrorCode::usage, or ErrorCode::no_device where none is usable.
OpenedDevices open_devices(const DeviceOptions& options, const std::string& faults = {});

}  // namespace kdray::api
