#include "base/process_memory.h"

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace kdray {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();

// Returns the number after `name`, the first word of its line; kUnknown when there is none.
std::uint64_t number_after(const fs::path& file, const std::string& name) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string word;
    if (std::uint64_t number = 0; words >> word && word == name && words >> number) return number;
  }
  return kUnknown;
}

std::uint64_t kib_after(const fs::path& file, const std::string& name) {
  const std::uint64_t kib = number_after(file, name);
  return kib == kUnknown ? kUnknown : kib * 1024;
}

// Returns the number that the file is; "max", which stands for no limit, is none.
std::uint64_t number_in(const fs::path& file) {
  std::ifstream in(file);
  std::uint64_t number = 0;
  return in >> number ? number : kUnknown;
}

std::uint64_t left_of(std::uint64_t limit, std::uint64_t used) {
  return limit > used ? limit - used : 0;
}

std::uint64_t left_of_address_space(const SystemFiles& files) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnknown;
  const std::uint64_t used = kib_after(files.proc / "self" / "status", "VmSize:");
  return used == kUnknown ? limit.rlim_cur : left_of(limit.rlim_cur, used);
}

// A version of control groups: where its groups lie, and what its files are called.
struct Hierarchy {
  fs::path root;
  const char* limit;
  const char* used;
  const char* droppable;  // pages of files, which the system takes back before it kills
};

std::uint64_t left_in(const fs::path& group, const Hierarchy& h) {
  const std::uint64_t limit = number_in(group / h.limit), used = number_in(group / h.used);
  if (limit == kUnknown || used == kUnknown) return kUnknown;
  const std::uint64_t droppable = number_after(group / "memory.stat", h.droppable);
  return left_of(limit, droppable == kUnknown ? used : left_of(used, droppable));
}

// Returns the least that the group and those above it leave. In a container the path may be one of the
// host's, which is not there: its own group is then the root.
std::uint64_t left_along(const std::string& path, const Hierarchy& h) {
  std::uint64_t least = left_in(h.root, h);
  fs::path group = h.root;
  for (const fs::path& part : fs::path(path).relative_path()) {
    if (part == "..") break;
    group /= part;
    least = std::min(least, left_in(group, h));
  }
  return least;
}

bool names_memory(const std::string& controllers) {
  return ("," + controllers + ",").find(",memory,") != std::string::npos;
}

// Lines "NUMBER:CONTROLLERS:PATH"; version 2 names no controllers.
std::uint64_t left_of_control_groups(const SystemFiles& files) {
  const Hierarchy v1{files.cgroup / "memory", "memory.limit_in_bytes", "memory.usage_in_bytes",
                     "total_inactive_file"};
  const Hierarchy v2{files.cgroup, "memory.max", "memory.current", "inactive_file"};
  std::uint64_t least = kUnknown;
  std::ifstream in(files.proc / "self" / "cgroup");
  for (std::string line; std::getline(in, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1),
                      path = line.substr(second + 1);
    if (controllers.empty()) least = std::min(least, left_along(path, v2));
    if (names_memory(controllers)) least = std::min(least, left_along(path, v1));
  }
  return least;
}

}  // namespace

std::uint64_t free_memory(const SystemFiles& files) {
  return std::min({kib_after(files.proc / "meminfo", "MemAvailable:"), left_of_address_space(files),
                   left_of_control_groups(files)});
}

namespace {

// "VmRSS:" (what is resident) or "VmHWM:" (the most that was).
std::optional<std::uint64_t> resident(const std::string& name) {
  std::ifstream in("/proc/self/status");
  for (std::string word; in >> word;)
    if (std::uint64_t kib = 0; word == name && in >> kib) return kib * 1024;
  return std::nullopt;
}

// Has the kernel count the peak of resident memory anew.
bool forget_peak() {
  std::ofstream out("/proc/self/clear_refs");
  out << "5" << std::flush;
  return static_cast<bool>(out);
}

}  // namespace

void give_back_free_memory() {
#if defined(__GLIBC__)
  ::malloc_trim(0);
#endif
}

std::optional<std::uint64_t> peak_bytes_of(const std::function<void()>& work) {
  give_back_free_memory();  // it would count as held already
  const bool counts_anew = forget_peak();
  const std::optional<std::uint64_t> before = resident("VmRSS:");
  work();
  const std::optional<std::uint64_t> peak = resident("VmHWM:");
  if (!counts_anew || !before || !peak || *peak < *before) return std::nullopt;
  return *peak - *before;
}

std::optional<std::uint64_t> peak_bytes() {
  return resident("VmHWM:");
}

}  // namespace kdray
