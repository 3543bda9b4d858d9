// What    The OpenCL devices of this machine, and the choice of one by what the user said.
#pragma once

#include <string>
#include <vector>

#include "device/opencl.h"
#include "kdray/device_info.h"

namespace kdray::device {

struct FoundDevice {
  DeviceInfo info;
  cl::Platform platform;
  cl::Device device;
};

// Every device of every platform, in the platforms' order; empty where there is none.
std::vector<FoundDevice> find_devices();

// Whether a spec leaves the choice to kdray: "auto" or empty.
bool is_auto(const std::string& spec);

// Whether it names a kind of device, and no device: "cpu", "gpu", "accelerator".
bool is_kind(const std::string& spec);

// The usable ones that "auto", or a kind, leaves the choice of, as kdray prefers them: GPUs, CPUs, others.
std::vector<FoundDevice> devices_by_preference(const std::string& spec = "auto");

// spec: "auto" (a GPU if there is a usable one, else a CPU), "cpu", "gpu", a number, or a part of a device's
// or platform's name. Throws ErrorCode::no_device, listing what there is.
FoundDevice choose_device(const std::string& spec);

}  // namespace kdray::device
