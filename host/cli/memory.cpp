#include "cli/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "base/error.h"
#include "cli/message.h"

namespace kdray::cli {

namespace {

// The bytes were measured as the growth of the process between 1024x1024 and 4096x4096 pixels, on the CPU: 55
// for a pixel and 50 for the six floats of all its channels, for the film, the picture, and what is being
// written of it.
constexpr std::uint64_t kPixelBytes = 56;
constexpr std::uint64_t kChannelBytes = 9;

constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();

// The number of KiB after `name` in a file of /proc; kUnknown when there is none.
std::uint64_t proc_bytes(const char* file, const std::string& name) {
  std::ifstream in(file);
  for (std::string word; in >> word;)
    if (std::uint64_t kib = 0; word == name && in >> kib) return kib * 1024;
  return kUnknown;
}

std::uint64_t left_of_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnknown;
  const std::uint64_t used = proc_bytes("/proc/self/status", "VmSize:");
  if (used == kUnknown) return limit.rlim_cur;
  return limit.rlim_cur > used ? limit.rlim_cur - used : 0;
}

}  // namespace

std::uint64_t free_memory() {
  return std::min(proc_bytes("/proc/meminfo", "MemAvailable:"), left_of_limit());
}

std::uint64_t picture_bytes(std::uint64_t width, std::uint64_t height, std::uint64_t n_channels) {
  return width * height * (kPixelBytes + n_channels * kChannelBytes);
}

void check_picture_fits(std::uint64_t width, std::uint64_t height, std::uint64_t n_channels,
                        std::uint64_t free) {
  const std::uint64_t needed = picture_bytes(width, height, n_channels);
  if (needed <= free) return;
  // The same shape, with a margin for the scene and its tree.
  const double shrink = std::sqrt(0.8 * static_cast<double>(free) / static_cast<double>(needed));
  const auto side = [shrink](std::uint64_t n) {
    return std::max(1.0, std::floor(static_cast<double>(n) * shrink));
  };
  throw Error(
      ErrorCode::out_of_memory,
      fmt::format(
          "a picture of {}x{} takes about {} of memory, and {} are free; --size {:.0f}x{:.0f} would fit",
          width, height, bytes_in_words(needed), bytes_in_words(free), side(width), side(height)));
}

}  // namespace kdray::cli
