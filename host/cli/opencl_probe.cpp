#include "cli/opencl_probe.h"

#include <dlfcn.h>
#include <unistd.h>

#include <CL/cl.h>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
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

Driver inspect(const fs::path& file) {
  Driver driver{.file = file.string(), .library = {}, .why_not = {}};
  std::ifstream in(file);
  std::getline(in, driver.library);
  if (driver.library.empty()) {
    driver.why_not = "the file can't be read or is empty";
    return driver;
  }
  void* const handle = ::dlopen(driver.library.c_str(), RTLD_LAZY | RTLD_LOCAL);
  driver.opens = handle != nullptr;
  if (!handle) {
    const char* const reason = ::dlerror();
    driver.why_not = reason ? reason : "unknown reason";
  }
  // The library is not closed again: the loader is about to open it too, and drivers dislike being unloaded.
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
  if (fs::is_regular_file(place, error)) return {inspect(place)};
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

std::string pocl_cache_folder() {
  if (const std::string set = variable("POCL_CACHE_DIR"); !set.empty()) return set;
  if (const std::string base = variable("XDG_CACHE_HOME"); !base.empty()) return base + "/pocl/kcache";
  if (const std::string home = variable("HOME"); !home.empty()) return home + "/.cache/pocl/kcache";
  return "";
}

bool is_writable(const std::string& folder, std::string& why_not) {
  // A folder that does not exist yet will be made, so its nearest ancestor counts.
  std::error_code error;
  fs::path place = fs::absolute(folder, error);
  while (!fs::exists(place, error) && place != place.parent_path()) place = place.parent_path();
  std::string trial = (place / ".kdray-XXXXXX").string();
  const int descriptor = ::mkstemp(trial.data());
  if (descriptor < 0) {
    why_not = std::strerror(errno);
    return false;
  }
  ::close(descriptor);
  ::unlink(trial.c_str());
  return true;
}

}  // namespace kdray::cli
