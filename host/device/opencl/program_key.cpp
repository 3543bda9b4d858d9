#include "device/opencl/program_key.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string_view>
#include <vector>

#include "device/opencl/variant.h"

namespace kdray::device {

namespace {

std::string read_processor() {
  std::ifstream in("/proc/cpuinfo");
  std::string text;
  for (std::string line; std::getline(in, line) && !line.empty();)
    for (const std::string_view fact : {"vendor_id", "cpu family", "model", "stepping", "flags", "Features"})
      if (line.starts_with(fact)) text += line + '\n';
  return text;
}

// What Linux tells of the first core; empty elsewhere. It takes a tenth of a millisecond for each core.
const std::string& processor() {
  static const std::string text = read_processor();
  return text;
}

// PoCL's variables, but for those that only say where things are kept, or how many threads it has.
std::string pocl_environment() {
  std::vector<std::string> set;
  for (char** variable = environ; *variable; ++variable) {
    const std::string_view text = *variable;
    const bool is_of_no_program =
        text.starts_with("POCL_CACHE_DIR=") || text.starts_with("POCL_MAX_PTHREAD_COUNT=");
    if (text.starts_with("POCL_") && !is_of_no_program) set.emplace_back(text);
  }
  std::sort(set.begin(), set.end());
  return fmt::format("{}", fmt::join(set, "\n"));
}

}  // namespace

std::string identity_of(const cl::Device& device) {
  const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
  const bool cpu = (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) != 0;
  return fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}", platform.getInfo<CL_PLATFORM_NAME>(),
                     platform.getInfo<CL_PLATFORM_VERSION>(), device.getInfo<CL_DEVICE_NAME>(),
                     device.getInfo<CL_DEVICE_VENDOR>(), device.getInfo<CL_DEVICE_VERSION>(),
                     device.getInfo<CL_DRIVER_VERSION>(), device.getInfo<CL_DEVICE_OPENCL_C_VERSION>(),
                     cpu ? processor() : "", pocl_environment());
}

Hash program_key(const std::string& identity, const std::string& source, const std::string& options) {
  // The lengths keep what belongs to one apart from what belongs to the next.
  return hash_of(fmt::format("kdray program 1 {} {} {}\n{}\n{}\n{}", identity.size(), options.size(),
                             source.size(), identity, options, source));
}

std::uint64_t family_of(const std::string& identity, const std::string& source, const std::string& options) {
  return program_key(identity, source, "family " + options).high;
}

ProgramKey variant_key(const std::string& identity, const std::string& source, const std::string& options,
                       std::uint64_t mask) {
  return {program_key(identity, source, options_with(options, mask)), family_of(identity, source, options),
          mask};
}

}  // namespace kdray::device
