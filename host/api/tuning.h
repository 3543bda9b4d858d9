// What    The settings that a device works with: what was found for it (tune/database.h), or what kdray ships
//         with for its kind.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "device/opencl/context.h"
#include "device/tuning/database.h"
#include "engine/device_scene/device.h"
#include "layout/features.h"

namespace kdray::api {

tuning::Key tuning_key(const device::Context& context, bool global, layout::Features features);

// The file's entries; none where it is of no use, of which the options' tunings_ignored is told.
tuning::Database read_tunings(const DeviceOptions& options);

engine::Tuned tuned_for(const device::Context& context, bool global, layout::Features features,
                        const tuning::Database& tunings, const std::string& file);

}  // namespace kdray::api
