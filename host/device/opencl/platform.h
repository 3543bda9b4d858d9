// What    The OpenCL devices of this machine, and the choice of one by what the user said.
// Forks   PoCL starts its threads when it is first asked for its devices. A process that is forked off later
//         has none of them, and neither the old contexts nor new ones ever finish a command there. So such a
//         child is recognised: it is refused whatever needs OpenCL, and leaves alone what its parent had
//         opened.
#pragma once

#include <string>
#include <vector>

#include "device/opencl/opencl.h"
#include "kdray/device_info.h"

namespace kdray::device {

struct FoundDevice {
  DeviceInfo info;
  cl::Platform platform;
  cl::Device device;
};

// Returns whether this process was forked off after its parent had asked OpenCL for devices.
bool is_forked_off();
// Throws ErrorCode::no_device, saying what to do, where it was. Takes no lock: a thread that the fork left
// behind may have held any.
void refuse_after_fork();

// Returns every device of every platform, in the platforms' order; empty where there is none.
std::vector<FoundDevice> find_devices();

// Returns whether a spec leaves the choice to kdray: "auto" or empty.
bool is_auto(const std::string& spec);

// Returns whether it names a kind of device, not a device: "cpu", "gpu", "accelerator".
bool is_kind(const std::string& spec);

// Returns the usable devices that "auto", or a kind, may choose from, in the order in which kdray prefers
// them: GPUs, CPUs, others.
std::vector<FoundDevice> devices_by_preference(const std::string& spec = "auto");

// Returns the device that `spec` asks for: "auto" (a GPU if there is a usable one, else a CPU), "cpu", "gpu",
// a number, or a part of a device's or platform's name. Throws ErrorCode::no_device, listing what there is.
FoundDevice choose_device(const std::string& spec);

}  // namespace kdray::device
