#include "apps/cli/opencl_probe.h"

#include <dlfcn.h>

#include <CL/cl.h>
#include <algorithm>
#include <string_view>

extern char** environ;

namespace kdray::cli {

namespace {

std::string platform_text(cl_platform_id platform, cl_platform_info what) {
  std::size_t size = 0;
  if (clGetPlatformInfo(platform, what, 0, nullptr, &size) != CL_SUCCESS || size == 0) return "";
  std::string text(size, '\0');
  if (clGetPlatformInfo(platform, what, size, text.data(), nullptr) != CL_SUCCESS) return "";
  return text.c_str();  // up to the terminating zero
}

}  // namespace

// The library is not closed again: the loader is about to open it too, and drivers dislike being unloaded.
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
