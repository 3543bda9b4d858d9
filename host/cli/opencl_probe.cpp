#include "cli/opencl_probe.h"

#include <dlfcn.h>

#include <CL/cl.h>
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string_view>

extern char** environ;

namespace fs = std::filesystem;

namespace kdray::cli {

namespace {

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value ? value : "";
}

void try_to_open(Driver& driver) {
  void* const handle = ::dlopen(driver.library.c_str(), RTLD_LAZY | RTLD_LOCAL);
  driver.opens = handle != nullptr;
  if (!handle) {
    const char* const reason = ::dlerror();
    driver.why_not = reason ? reason : "unknown reason";
  }
  // The library is not closed again: the loader is about to open it too, and drivers dislike being unloaded.
}

// An .icd file: its first line names the library.
Driver inspect(const fs::path& file) {
  Driver driver{.file = file.string(), .library = {}, .why_not = {}};
  std::ifstream in(file);
  std::getline(in, driver.library);
  const bool is_text = std::none_of(driver.library.begin(), driver.library.end(),
                                    [](unsigned char c) { return std::iscntrl(c) && !std::isspace(c); });
  if (!is_text) driver.library.clear();
  if (driver.library.empty())
    driver.why_not =
        is_text ? "the file can't be read or is empty" : "the file is no text with a library's name";
  else
    try_to_open(driver);
  return driver;
}

std::string platform_text(cl_platform_id platform, cl_platform_info what) {
  std::size_t size = 0;
  if (clGetPlatformInfo(platform, what, 0, nullptr, &size) != CL_SUCCESS || size == 0) return "";
  std::string text(size, '\0');
  if (clGetPlatformInfo(platform, what, size, text.data(), nullptr) != CL_SUCCESS) return "";
  return text.c_str();  // up to the terminating zero
}

}  // namespace

std::string vendors_folder() {
  const std::string set = variable("OCL_ICD_VENDORS");
  return set.empty() ? "/etc/OpenCL/vendors" : set;
}

std::vector<Driver> find_drivers() {
  std::vector<Driver> drivers;
  const fs::path place = vendors_folder();
  std::error_code error;
  if (place.extension() == ".icd") return {inspect(place)};
  if (place.filename().string().find(".so") != std::string::npos && !fs::is_directory(place, error)) {
    Driver driver{.file = "OCL_ICD_VENDORS", .library = place.string(), .why_not = {}};
    try_to_open(driver);
    return {driver};
  }
  for (fs::directory_iterator i(place, error), end; !error && i != end; i.increment(error))
    if (i->path().extension() == ".icd") drivers.push_back(inspect(i->path()));
  std::sort(drivers.begin(), drivers.end(), [](const Driver& a, const Driver& b) { return a.file < b.file; });
  return drivers;
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

}  // namespace kdray::cli
