// What    kdray doctor: looks at everything kdray needs from the machine, and says in plain words what
//         is missing and what to do about it. Ends with a picture and a few rays of known answer on each
//         usable device.
// Errors  Exit code 3 when no device is usable (ErrorCode::no_device), so that scripts can ask it.
#include <fmt/format.h>

#include <functional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/message.h"
#include "cli/opencl_probe.h"
#include "cli/output.h"
#include "cli/self_test.h"
#include "kdray/kdray.h"

namespace kdray::cli {

namespace {

constexpr const char* kInstall =
    "install PoCL, which runs on the CPU: 'apt install pocl-opencl-icd' (Debian, Ubuntu), 'dnf install pocl' "
    "(Fedora); or your GPU's OpenCL driver";

void good(const std::string& text) {
  print("[ok]   " + one_line(text) + "\n");
}
void bad(const std::string& text, const std::string& remedy) {
  print("[bad]  " + one_line(text) + "\n" + (remedy.empty() ? "" : "       -> " + one_line(remedy) + "\n"));
}
void note(const std::string& text) {
  print("[note] " + one_line(text) + "\n");
}

void check_environment() {
  for (const Variable& v : opencl_environment()) {
    note(fmt::format("{}={}", v.name, v.value));
    if (v.name == "OCL_ICD_VENDORS")
      note("OCL_ICD_VENDORS replaces /etc/OpenCL/vendors: unset it if drivers are missing below");
    if (v.name == "POCL_DEVICES" && v.value.empty())
      note("POCL_DEVICES is empty, which leaves PoCL without a device: unset it");
  }
}

void check_drivers() {
  const std::vector<Driver> drivers = find_drivers();
  if (drivers.empty()) bad("no OpenCL driver is registered in " + vendors_folder(), kInstall);
  for (const Driver& d : drivers) {
    if (d.opens)
      good(fmt::format("driver {} ({})", d.library, d.file));
    else
      bad(fmt::format("driver {} ({}): {}", d.library, d.file, d.why_not),
          "install its package again, or remove the .icd file");
  }
}

bool is_pocl(const Platform& p) {
  return p.name.find("Portable Computing Language") != std::string::npos;
}

void check_platforms() {
  const std::vector<Platform> platforms = find_platforms();
  bool pocl = false;
  if (platforms.empty()) bad("OpenCL's loader finds no platform", kInstall);
  for (const Platform& p : platforms) {
    pocl = pocl || is_pocl(p);
    const std::string text =
        fmt::format("platform {} ({}), {} device{}", p.name, p.version, p.devices, p.devices == 1 ? "" : "s");
    if (p.devices > 0)
      good(text);
    else
      bad(text, is_pocl(p) ? "PoCL without a device: look at POCL_DEVICES, and at its LLVM packages"
                           : "its driver sees no hardware: is the device there, and may this user open it?");
  }
  if (!platforms.empty() && !pocl) note("PoCL is not installed; kdray works without it on the devices above");
  if (!pocl) return;
  const std::string cache = pocl_cache_folder();
  std::string why_not;
  if (cache.empty())
    bad("PoCL has no place for its kernel cache", "set HOME, XDG_CACHE_HOME or POCL_CACHE_DIR");
  else if (is_writable(cache, why_not))
    good("PoCL's kernel cache " + cache + " is writable");
  else
    bad(fmt::format("PoCL's kernel cache {} is not writable ({})", cache, why_not),
        "set POCL_CACHE_DIR to a folder of yours; without it kernels are compiled again in every run");
}

// Tells what the test throws, so that a fault of one device doesn't hide the others.
std::string tried(const std::function<std::string()>& test) {
  try {
    return test();
  } catch (const std::exception& error) {
    return error.what();
  }
}

// Returns how many devices are usable and pass the self-test.
int check_devices() {
  int passed = 0;
  for (const DeviceInfo& d : devices()) {
    const std::string name = fmt::format("device {} {}", d.number, d.name);
    if (!d.usable) {
      bad(fmt::format("{}: {}", name, d.why_not),
          "kdray can't use it; another device or a newer driver may do");
      continue;
    }
    const std::string wrong = tried([&d] { return self_test(std::to_string(d.number)); });
    if (wrong.empty()) {
      good(name + ": the test picture and rays are right");
      ++passed;
    } else {
      bad(fmt::format("{}: the self-test fails: {}", name, wrong),
          "update its driver; choose another with --device");
    }
  }
  return passed;
}

int run() {
  good("kdray " KDRAY_VERSION);
  check_environment();
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
