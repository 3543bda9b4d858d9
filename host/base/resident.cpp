#include "base/resident.h"

#include <unistd.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <memory>

namespace kdray {

namespace {

using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

Stream open_own(const char* name) {
  return {std::fopen(name, "re"), std::fclose};
}

// The bytes of the ranges that lie from `begin` to `end`.
std::uint64_t within(const std::map<void*, std::size_t>& ranges, std::uintptr_t begin, std::uintptr_t end) {
  std::uint64_t sum = 0;
  for (auto r = ranges.lower_bound(reinterpret_cast<void*>(begin)); r != ranges.end(); ++r) {
    if (reinterpret_cast<std::uintptr_t>(r->first) >= end) break;
    sum += r->second;
  }
  return sum;
}

}  // namespace

std::uint64_t resident_of_files() {
  const Stream file = open_own("/proc/self/statm");
  std::uint64_t pages = 0;
  if (!file || std::fscanf(file.get(), "%*u %*u %" SCNu64, &pages) != 1) return 0;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

std::uint64_t resident_of(const std::map<void*, std::size_t>& ranges) {
  const Stream file = open_own("/proc/self/smaps");
  if (!file) return 0;
  std::uint64_t sum = 0, ours = 0;
  char line[4096];
  while (std::fgets(line, sizeof line, file.get()) != nullptr) {
    std::uintptr_t begin = 0, end = 0;
    std::uint64_t kilobytes = 0;
    if (std::sscanf(line, "%" SCNxPTR "-%" SCNxPTR " ", &begin, &end) == 2)
      ours = within(ranges, begin, end);
    else if (ours > 0 && std::sscanf(line, "Rss: %" SCNu64, &kilobytes) == 1)
      sum += std::min(ours, kilobytes * 1024);
  }
  return sum;
}

}  // namespace kdray
