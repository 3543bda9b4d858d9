#include "device/opencl/pocl_cache.h"

#include <fmt/format.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "base/cache_folder.h"
#include "base/temporary.h"

namespace kdray::device {

namespace fs = std::filesystem;

namespace {

// A program takes up to 2 MiB while it is compiled; a first run compiles several.
constexpr std::uint64_t kLeastFree = std::uint64_t{16} << 20;
constexpr const char* kTemporary = "kdray-pocl-";

// Returns the folder that PoCL would choose. It is empty where PoCL is told to have none, which ends the
// process.
fs::path pocls_own() {
  if (const char* const set = std::getenv("POCL_CACHE_DIR")) return set;
  if (const char* const caches = std::getenv("XDG_CACHE_HOME"); caches && *caches)
    return fs::path(caches) / "pocl" / "kcache";
  if (const char* const home = std::getenv("HOME")) return fs::path(home) / ".cache" / "pocl" / "kcache";
  return "/tmp/pocl/kcache";
}

fs::path kdrays_own() {
  const char* const set = std::getenv("KDRAY_CACHE_DIR");
  const fs::path folder = set ? fs::path(set) : user_cache_folder();
  return folder.empty() ? folder : folder / "pocl";
}

// Where a folder that goes with the process may be made, the best first.
std::vector<fs::path> temporary_places() {
  std::vector<fs::path> places;
  std::error_code error;
  if (const fs::path usual = fs::temp_directory_path(error); !error) places.push_back(usual);
  if (const char* const runtime = std::getenv("XDG_RUNTIME_DIR"); runtime && *runtime)
    places.push_back(runtime);
  places.push_back("/dev/shm");
  return places;
}

// Removed at the end. PoCL's own clean-up comes before that, since it begins to work after this is made.
fs::path make_temporary() {
  static std::unique_ptr<Temporary> folder;
  for (const fs::path& where : temporary_places()) {
    if (why_no_cache(where).empty()) folder = make_temporary_folder(kTemporary, where);
    if (folder) return folder->path();
  }
  return {};
}

// Kernels of any work-group size alone: PoCL would compile each anew for the first launch's size, and once
// more for any size where programs are kept. Where that is said already, it stands.
void compile_for_any_size() {
  ::setenv("POCL_WORK_GROUP_SPECIALIZATION", "0", 0);
}

// PoCL sets this one while it looks for devices, which a thread may do beside others that read variables:
// adding one moves them all, giving one that is there another value doesn't.
void add_what_pocl_sets() {
  ::setenv("HWLOC_PLUGINS_PATH", "/dev/null", 0);
}

PoclCache choose() {
  compile_for_any_size();
  add_what_pocl_sets();
  PoclCache cache;
  cache.folder = cache.preferred = pocls_own();
  cache.why_not = why_no_cache(cache.preferred);
  if (cache.why_not.empty()) return cache;
  fs::path other = kdrays_own();
  if (!why_no_cache(other).empty()) {
    other = make_temporary();
    cache.temporary = !other.empty();
  }
  if (other.empty()) {
    cache.unusable = fmt::format(
        "PoCL has no folder to compile in: '{}': {}, and no other will do (kdray's cache, TMPDIR, "
        "XDG_RUNTIME_DIR, "
        "/dev/shm); set POCL_CACHE_DIR to a folder that can be written, has {} MiB of room and may hold "
        "programs",
        cache.preferred.string(), cache.why_not, kLeastFree >> 20);
  } else {
    cache.folder = other;
    ::setenv("POCL_CACHE_DIR", other.c_str(), 1);
  }
  return cache;
}

// Returns whether what is in the file may be executed. A file system mounted with noexec refuses that, and
// PoCL, whose kernels are shared libraries there, ends the process when it is refused.
bool is_executable(int descriptor) {
  constexpr std::size_t kBytes = 1;
  if (::ftruncate(descriptor, kBytes) != 0) return false;
  void* const mapped = ::mmap(nullptr, kBytes, PROT_READ | PROT_EXEC, MAP_PRIVATE, descriptor, 0);
  if (mapped == MAP_FAILED) return false;
  ::munmap(mapped, kBytes);
  return true;
}

}  // namespace

std::string why_no_cache(const fs::path& folder) {
  if (folder.empty()) return "there is no such place";
  // What does not exist yet will be made: its nearest ancestor counts.
  std::error_code error;
  fs::path place = fs::absolute(folder, error);
  while (!fs::exists(place, error) && place != place.parent_path()) place = place.parent_path();
  std::string trial = (place / ".kdray-XXXXXX").string();
  const int descriptor = ::mkstemp(trial.data());
  if (descriptor < 0) return fmt::format("it is not writable ({})", std::strerror(errno));
  struct statvfs system {};
  const bool known = ::fstatvfs(descriptor, &system) == 0;
  const bool executable = is_executable(descriptor);
  ::close(descriptor);
  ::unlink(trial.c_str());
  if (known && std::uint64_t{system.f_bavail} * system.f_frsize < kLeastFree) return "its disk is full";
  if (!executable) return "nothing in it may be executed (a file system mounted with noexec?)";
  return "";
}

const PoclCache& pocl_cache() {
  static const PoclCache cache = choose();
  return cache;
}

bool is_pocl(const std::string& platform) {
  return platform.find("Portable Computing Language") != std::string::npos;
}

}  // namespace kdray::device
