// What    What the kernels compute in, and what double leaves: the binary walk and PDPRT, on devices that
//         have it.
#pragma once

#include "accel/prepare/prepared.h"
#include "engine/device_scene/device_scene.h"
#include "kdray/kdray.h"

namespace kdray::api {

// The walk of that precision. Throws ErrorCode::usage when there is no such walk in it, ErrorCode::no_device
// when the device doesn't compute in it.
Traversal traversal_in(Precision precision, Traversal wanted, const DeviceInfo& device);

// The same of rays from outside, for all devices; and the scene has to have the form that is walked.
Traversal traversal_of_rays(Precision precision, Traversal wanted, const engine::DeviceScene& devices);

// Throws ErrorCode::usage where the binary form is walked and the scene was prepared without it.
void check_form(bool is_walked, const prepare::Prepared& scene);

// The same for what a picture asks for: its channels too, but in a scene with instances, whose channels the
// wide form has; all but the cost of the binary walk.
void check_channels(const RenderOptions& options, const prepare::Prepared& scene);

// Throws ErrorCode::usage for what odprt would have to do in double.
void check_division(const RenderOptions& options);

}  // namespace kdray::api
