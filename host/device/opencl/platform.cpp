#include "device/opencl/platform.h"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <cctype>

#include "base/text.h"
#include "device/opencl/opencl_error.h"
#include "device/opencl/pocl_cache.h"

namespace kdray::device {

namespace {

std::atomic<bool> forked_off{false};

// Called before OpenCL's first call.
void watch_for_forks() {
  static const int watching = ::pthread_atfork(nullptr, nullptr, [] { forked_off = true; });
  static_cast<void>(watching);
}

std::string trimmed(std::string text) {
  while (!text.empty() && (text.back() == '\0' || std::isspace(static_cast<unsigned char>(text.back()))))
    text.pop_back();
  const auto first =
      std::find_if(text.begin(), text.end(), [](unsigned char c) { return std::isspace(c) == 0; });
  return std::string(first, text.end());
}

std::string kind_of(cl_device_type type) {
  if (type & CL_DEVICE_TYPE_GPU) return "gpu";
  if (type & CL_DEVICE_TYPE_CPU) return "cpu";
  return "accelerator";
}

// Returns why kdray's kernels can't run on this device; an empty text where they can.
std::string why_unusable(const cl::Device& device) {
  if (!device.getInfo<CL_DEVICE_AVAILABLE>()) return "not available";
  if (!device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>()) return "has no compiler";
  if (!device.getInfo<CL_DEVICE_ENDIAN_LITTLE>()) return "is big-endian";
  const cl_device_fp_config fp = device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>();
  if (!(fp & CL_FP_INF_NAN)) return "has no infinities in float";
  if (!(fp & CL_FP_ROUND_TO_NEAREST)) return "does not round float to nearest";
  return "";
}

DeviceInfo describe(const cl::Platform& platform, const cl::Device& device, int number) {
  DeviceInfo info;
  info.number = number;
  info.name = trimmed(device.getInfo<CL_DEVICE_NAME>());
  info.platform = trimmed(platform.getInfo<CL_PLATFORM_NAME>());
  info.version = trimmed(device.getInfo<CL_DEVICE_VERSION>());
  info.driver = trimmed(device.getInfo<CL_DRIVER_VERSION>());
  info.kind = kind_of(device.getInfo<CL_DEVICE_TYPE>());
  info.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  info.global_memory = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  info.max_allocation = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  info.double_precision = device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() != 0;
  info.why_not = why_unusable(device);
  info.usable = info.why_not.empty();
  return info;
}

bool is_number(const std::string& text) {
  return !text.empty() && text.size() < 6 &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

bool matches(const DeviceInfo& info, const std::string& spec) {
  if (is_number(spec)) return info.number == std::stoi(spec);
  if (is_kind(spec)) return info.kind == spec;
  return lower(info.name).find(spec) != std::string::npos ||
         lower(info.platform).find(spec) != std::string::npos;
}

std::string list_of(const std::vector<FoundDevice>& devices) {
  std::string text;
  for (const FoundDevice& d : devices)
    text += fmt::format("{}{}: {} ({}{})", text.empty() ? "" : ", ", d.info.number, d.info.name,
                        d.info.platform, d.info.usable ? "" : "; unusable: " + d.info.why_not);
  return text;
}

std::vector<FoundDevice> by_preference(const std::vector<FoundDevice>& devices) {
  std::vector<FoundDevice> ordered;
  for (const char* kind : {"gpu", "cpu", "accelerator"})
    for (const FoundDevice& d : devices)
      if (d.info.usable && d.info.kind == kind) ordered.push_back(d);
  return ordered;
}

}  // namespace

bool is_auto(const std::string& spec) {
  return spec.empty() || lower(spec) == "auto";
}

bool is_kind(const std::string& spec) {
  const std::string kind = lower(spec);
  return kind == "cpu" || kind == "gpu" || kind == "accelerator";
}

std::vector<FoundDevice> devices_by_preference(const std::string& spec) {
  std::vector<FoundDevice> devices = by_preference(find_devices());
  if (is_kind(spec))
    std::erase_if(devices, [kind = lower(spec)](const FoundDevice& d) { return d.info.kind != kind; });
  return devices;
}

bool is_forked_off() {
  return forked_off;
}

void refuse_after_fork() {
  if (is_forked_off())
    throw Error(
        ErrorCode::no_device,
        "this process was forked off after its parent had begun to use OpenCL, which does not outlive a "
        "fork: start it by spawn instead (Python: multiprocessing.get_context(\"spawn\")), or fork "
        "before the first commit, question or list of devices");
}

std::vector<FoundDevice> find_devices() {
  refuse_after_fork();
  watch_for_forks();
  pocl_cache();  // before OpenCL's first call
  std::vector<FoundDevice> found;
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error&) {
    return found;  // the loader says "no platform" by an error
  }
  for (const cl::Platform& platform : platforms) {
    std::vector<cl::Device> devices;
    try {
      platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
      for (const cl::Device& device : devices)
        found.push_back({describe(platform, device, static_cast<int>(found.size())), platform, device});
    } catch (const cl::Error&) {
      continue;  // a platform without devices
    }
  }
  return found;
}

FoundDevice choose_device(const std::string& spec) {
  const std::vector<FoundDevice> devices = find_devices();
  if (devices.empty() && !pocl_cache().unusable.empty())
    throw Error(ErrorCode::no_device, "no OpenCL device found; " + pocl_cache().unusable);
  if (devices.empty())
    throw Error(ErrorCode::no_device,
                "no OpenCL device found; install one (Debian: apt-get install pocl-opencl-icd), then see "
                "`kdray doctor`");
  if (is_auto(spec)) {
    const std::vector<FoundDevice> ordered = by_preference(devices);
    if (!ordered.empty()) return ordered.front();
  } else {
    for (const FoundDevice& d : devices)
      if (d.info.usable && matches(d.info, lower(spec))) return d;
  }
  throw Error(ErrorCode::no_device,
              fmt::format("no usable OpenCL device is called '{}'; there is {}", spec, list_of(devices)));
}

}  // namespace kdray::device
