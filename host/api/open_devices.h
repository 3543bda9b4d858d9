// What    Opens the devices that DeviceOptions names, and a scene on them. Each has passed the self-test,
//         keeps what it builds in the folder that the options name, and works with the settings that were
//         found for it (device/tuning/database.h), or that kdray ships with for its kind.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "api/hooks.h"
#include "device/opencl/context.h"
#include "device/opencl/verdicts.h"
#include "device/tuning/database.h"
#include "engine/device_scene/device_scene.h"
#include "kdray/kdray.h"
#include "layout/features.h"

namespace kdray::api {

tuning::Key tuning_key(const device::Context& context, bool global, layout::Features features);

// The file's entries; none where it is of no use, of which the options' tunings_ignored is told.
tuning::Database read_tunings(const DeviceOptions& options);

engine::Tuned tuned_for(const device::Context& context, bool global, layout::Features features,
                        const tuning::Database& tunings, const std::string& file);

device::Builds builds_of(const DeviceOptions& options);

// Where verdicts on devices are kept: with the programs. Without a folder for those nothing is written, but
// what other runs have found out in the default one counts.
device::Verdicts verdicts_of(const DeviceOptions& options);

// Leaves out drivers that can't even be asked for their devices (probe/trial/drivers.h), before OpenCL's
// first call, and says why, a line for each.
std::vector<std::string> leave_out_drivers(const DeviceOptions& options);

struct OpenedDevices {
  std::vector<device::Context> contexts;
  OpenSeconds seconds;
};

// `faults` as in Hooks. Throws ErrorCode::usage, or ErrorCode::no_device where none is usable.
OpenedDevices open_devices(const DeviceOptions& options, const std::string& faults = {});

// The scene on these devices, with the settings that were found for them. It is not uploaded yet.
std::shared_ptr<engine::DeviceScene> open_scene(const prepare::Prepared& scene, const DeviceOptions& options,
                                                const Hooks& hooks = {});

}  // namespace kdray::api
