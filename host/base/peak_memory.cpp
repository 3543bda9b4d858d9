#include "base/peak_memory.h"

#include <fstream>
#include <string>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace kdray {

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
