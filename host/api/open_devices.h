// What    Opens the devices that DeviceOptions names: each has passed the self-test, and keeps what it builds
//         in the folder that the options name.
#pragma once

#include <vector>

#include "device/context.h"
#include "kdray/kdray.h"

namespace kdray::api {

device::Builds builds_of(const DeviceOptions& options);

// Throws ErrorCode::usage, or ErrorCode::no_device where none is usable.
std::vector<device::Context> open_devices(const DeviceOptions& options);

}  // namespace kdray::api
