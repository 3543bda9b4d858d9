// What    kdray doctor: looks at everything kdray needs from the machine, and says in plain words what
//         is missing and what to do about it. Ends with a picture and a few rays of known answer on each
//         usable device. Drivers are tried in processes of their own (probe/trial/trial.h), and what comes of
//         it is remembered in place of older verdicts.
// Errors  Exit code 3 when no device is usable (ErrorCode::no_device), so that scripts can ask it.
#include <CL/cl.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/command.h"
#include "apps/cli/output.h"
#include "apps/cli/self_test.h"
#include "device/opencl/platform.h"
#include "device/opencl/pocl_cache.h"
#include "device/opencl/verdicts.h"
#include "kdray/kdray.h"
#include "probe/selftest/self_test.h"
#include "probe/trial/devices.h"
#include "probe/trial/drivers.h"
#include "scene/import/load.h"

extern char** environ;

namespace kdray::cli {

namespace {

constexpr const char* kInstall =
    "install PoCL, which runs on the CPU: 'apt install pocl-opencl-icd' (Debian, Ubuntu), 'dnf install pocl' "
    "(Fedora); or your GPU's OpenCL driver";

constexpr const char* kAnew = "install its package again, or remove the .icd file";

void good(const std::string& text) {
  print("[ok]   " + one_line(text) + "\n");
}
void bad(const std::string& text, const std::string& remedy) {
  print("[bad]  " + one_line(text) + "\n" + (remedy.empty() ? "" : "       -> " + one_line(remedy) + "\n"));
}
void note(const std::string& text) {
  print("[note] " + one_line(text) + "\n");
}

// ---- What OpenCL's loader sees on this machine

struct Platform {
  std::string name, version;
  std::uint32_t devices = 0;
};

struct Variable {
  std::string name, value;
};

std::string platform_text(cl_platform_id platform, cl_platform_info what) {
  std::size_t size = 0;
  if (clGetPlatformInfo(platform, what, 0, nullptr, &size) != CL_SUCCESS || size == 0) return "";
  std::string text(size, '\0');
  if (clGetPlatformInfo(platform, what, size, text.data(), nullptr) != CL_SUCCESS) return "";
  return text.c_str();  // up to the terminating zero
}

// Returns why the dynamic linker can't open this library, in its words; empty: it can. The library is not
// closed again: the loader is about to open it too, and drivers dislike being unloaded.
std::string why_not_opened(const std::string& library) {
  if (::dlopen(library.c_str(), RTLD_LAZY | RTLD_LOCAL)) return "";
  const char* const reason = ::dlerror();
  return reason ? reason : "unknown reason";
}

std::vector<Platform> find_platforms() {
  cl_uint count = 0;
  if (clGetPlatformIDs(0, nullptr, &count) != CL_SUCCESS || count == 0) return {};
  std::vector<cl_platform_id> ids(count);
  if (clGetPlatformIDs(count, ids.data(), nullptr) != CL_SUCCESS) return {};
  std::vector<Platform> platforms;
  for (const cl_platform_id id : ids) {
    cl_uint devices = 0;
    if (clGetDeviceIDs(id, CL_DEVICE_TYPE_ALL, 0, nullptr, &devices) != CL_SUCCESS) devices = 0;
    platforms.push_back(
        {platform_text(id, CL_PLATFORM_NAME), platform_text(id, CL_PLATFORM_VERSION), devices});
  }
  return platforms;
}

// OCL_*, POCL_* and CUDA_VISIBLE_DEVICES, as far as set.
std::vector<Variable> opencl_environment() {
  std::vector<Variable> found;
  for (char** entry = environ; *entry; ++entry) {
    const std::string_view text = *entry;
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) continue;
    const std::string_view name = text.substr(0, equals);
    if (name.starts_with("OCL_") || name.starts_with("POCL_") || name == "CUDA_VISIBLE_DEVICES")
      found.push_back({std::string(name), std::string(text.substr(equals + 1))});
  }
  std::sort(found.begin(), found.end(), [](const Variable& a, const Variable& b) { return a.name < b.name; });
  return found;
}

// ---- What is checked

void check_environment() {
  for (const Variable& v : opencl_environment()) {
    note(fmt::format("{}={}", v.name, v.value));
    if (v.name == "OCL_ICD_VENDORS")
      note("OCL_ICD_VENDORS replaces /etc/OpenCL/vendors: unset it if drivers are missing below");
    if (v.name == "POCL_DEVICES" && v.value.empty())
      note("POCL_DEVICES is empty, which leaves PoCL without a device: unset it");
  }
}

// Asks each driver for its devices, in a process of its own, and leaves out those that don't survive that;
// only then are the others opened here.
void check_drivers() {
  trial::ListingOptions options;
  options.verdicts = device::Verdicts(default_program_folder());
  options.anew = true;
  const std::vector<trial::DriverVerdict>& drivers = trial::mind_drivers(options);
  if (drivers.empty()) bad("no OpenCL driver is registered in " + trial::vendors_folder().string(), kInstall);
  for (const trial::DriverVerdict& d : drivers) {
    const std::string name = fmt::format("driver {} ({})", d.driver.library, d.driver.where());
    if (!d.driver.unreadable.empty()) {
      bad(fmt::format("{}: {}", name, d.driver.unreadable), kAnew);
    } else if (d.left_out) {
      bad(fmt::format("{}: it {}", name, d.verdict.text),
          "kdray leaves it out: update the driver, or remove the .icd file");
    } else if (const std::string why = why_not_opened(d.driver.library); !why.empty()) {
      bad(fmt::format("{}: {}", name, why), kAnew);
    } else {
      good(name);
    }
  }
}

// PoCL without a device is broken. Another driver may well be there for hardware that isn't, as Mesa's are.
void check_platform(const Platform& p, bool another_has_devices) {
  const std::string text =
      fmt::format("platform {} ({}), {} device{}", p.name, p.version, p.devices, p.devices == 1 ? "" : "s");
  if (p.devices > 0)
    good(text);
  else if (device::is_pocl(p.name))
    bad(text, "PoCL without a device: look at POCL_DEVICES, and at its LLVM packages");
  else if (another_has_devices)
    note(text + ": its driver sees no hardware of its own");
  else
    bad(text, "its driver sees no hardware: is the device there, and may this user open it?");
}

void check_pocl_cache() {
  const device::PoclCache& cache = device::pocl_cache();
  if (!cache.unusable.empty()) return bad(cache.unusable, "");
  if (cache.why_not.empty()) return good("PoCL's kernel cache " + cache.folder.string() + " is writable");
  note(fmt::format("PoCL's kernel cache would be '{}': {}. kdray has it use {} instead{}",
                   cache.preferred.string(), cache.why_not, cache.folder.string(),
                   cache.temporary
                       ? ", for this run only; set POCL_CACHE_DIR or KDRAY_CACHE_DIR to a folder of "
                         "yours to keep what is compiled"
                       : ""));
}

void check_platforms() {
  const std::vector<Platform> platforms = find_platforms();
  const auto is_pocl = [](const Platform& p) { return device::is_pocl(p.name); };
  const bool any_device = std::ranges::any_of(platforms, [](const Platform& p) { return p.devices > 0; });
  if (platforms.empty()) bad("OpenCL's loader finds no platform", kInstall);
  for (const Platform& p : platforms) check_platform(p, any_device);
  const bool pocl = std::ranges::any_of(platforms, is_pocl);
  if (!platforms.empty() && !pocl) note("PoCL is not installed; kdray works without it on the devices above");
  if (pocl) check_pocl_cache();
}

// Returns what the test throws as what is wrong, so that a fault of one device doesn't hide the others.
std::string tried(const std::function<std::string()>& test) {
  try {
    return test();
  } catch (const std::exception& error) {
    return error.what();
  }
}

// Returns what is wrong with the device, tried in a child process where possible; empty: nothing.
std::string fault_of(const device::FoundDevice& found) {
  const auto here = [&found] { return self_test(std::to_string(found.info.number)); };
  const auto in_child = [&found] {
    trial::Trial picture(trial::Subject::picture, selftest::verdict_key(found.device));
    return picture.outcome();
  };
  trial::Outcome outcome = trial::try_anew(found, device::Verdicts(default_program_folder()));
  if (outcome.verdict && outcome.verdict->passed) outcome = in_child();
  if (!outcome.verdict) return tried(here);
  return outcome.verdict->passed ? "" : outcome.verdict->text;
}

// Returns how many devices are usable and pass the self-test.
int check_devices() {
  int passed = 0;
  for (const device::FoundDevice& found : device::find_devices()) {
    const DeviceInfo& d = found.info;
    const std::string name = fmt::format("device {} {}", d.number, d.name);
    if (!d.usable) {
      bad(fmt::format("{}: {}", name, d.why_not),
          "kdray can't use it; another device or a newer driver may do");
      continue;
    }
    const std::string wrong = tried([&found] { return fault_of(found); });
    if (wrong.empty()) {
      good(name + ": the test picture and rays are right");
      ++passed;
    } else {
      bad(fmt::format("{}: {}", name, wrong), "update its driver; choose another with --device");
    }
  }
  return passed;
}

// Says which formats this kdray reads. Nobody needs all of them, so that a missing one is no fault.
void tell_abilities() {
  for (const scene::Ability& a : scene::abilities())
    note(a.here ? fmt::format("reads {}", a.what)
                : fmt::format("does not read {}: it was built without {}", a.what, a.package));
}

int run() {
  good("kdray " KDRAY_VERSION);
  tell_abilities();
  check_environment();
  device::pocl_cache();  // before OpenCL's first call
  check_drivers();
  check_platforms();
  if (check_devices() == 0)
    throw Error(ErrorCode::no_device, "no usable OpenCL device; the lines marked [bad] say why");
  return 0;
}

}  // namespace

Command add_doctor(CLI::App& kdray) {
  CLI::App* const app =
      kdray.add_subcommand("doctor", "Check what kdray needs from this machine, and say what is missing");
  return {app, [] { return run(); }};
}

}  // namespace kdray::cli
