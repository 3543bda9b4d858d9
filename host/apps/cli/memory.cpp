#include "apps/cli/memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/cli/output.h"
#include "base/error.h"

namespace kdray::cli {

namespace {

// Bytes for each pixel, measured as the growth of the process' peak from 2048x2048 over 4096x4096 to
// 8192x8192, on the CPU, and rounded up: 30.5 for a PNG of 8 bits, 34 of 16, 42 for an EXR, 6.8 for each
// channel, 25 for what adaptive sampling knows of a pixel. The film is held in bands, one
// for each queue.
constexpr std::uint64_t kPngBytes = 32, kDeepPngBytes = 36, kExrBytes = 43;
constexpr std::uint64_t kChannelBytes = 7, kAdaptiveBytes = 26;
constexpr std::uint64_t kFilmBytes = 24, kLargestBand = std::uint64_t{256} << 20;

// For each ray, measured in the same way between 1 and 10 million: the ray, its hit, the device's copies of
// both, and the file.
constexpr std::uint64_t kRayBytes = 96;

std::uint64_t file_bytes(const PictureNeeds& picture) {
  if (picture.exr) return kExrBytes;
  return picture.bits > 8 ? kDeepPngBytes : kPngBytes;
}

}  // namespace

std::uint64_t picture_bytes(const PictureNeeds& p) {
  const std::uint64_t pixels = p.width * p.height;
  const std::uint64_t each = file_bytes(p) + p.n_channels * kChannelBytes + (p.adaptive ? kAdaptiveBytes : 0);
  return pixels * each + p.n_queues * std::min(pixels * kFilmBytes, kLargestBand);
}

void check_picture_fits(const PictureNeeds& picture, std::uint64_t free) {
  const std::uint64_t needed = picture_bytes(picture);
  if (needed <= free) return;
  // The same shape, with a margin for the scene and its tree. A film that is taken in bands does not shrink
  // with it.
  PictureNeeds smaller = picture;
  for (double shrink = 1; picture_bytes(smaller) > free - free / 5 && smaller.width * smaller.height > 1;) {
    shrink *= 0.98;
    const auto side = [shrink](std::uint64_t n) {
      return std::max<std::uint64_t>(1, static_cast<std::uint64_t>(static_cast<double>(n) * shrink));
    };
    smaller.width = side(picture.width);
    smaller.height = side(picture.height);
  }
  throw Error(
      ErrorCode::out_of_memory,
      fmt::format("a picture of {}x{} takes about {} of memory, and {} are free; --size {}x{} would fit",
                  picture.width, picture.height, bytes_in_words(needed), bytes_in_words(free), smaller.width,
                  smaller.height));
}

void check_rows_fit(const char* name, std::uint64_t n_rows, std::uint64_t bytes_each, std::uint64_t free) {
  const std::uint64_t most = free / bytes_each;
  if (n_rows <= most) return;
  throw Error(ErrorCode::out_of_memory,
              fmt::format("{} {} take about {} of memory, and {} are free; {} at a time would fit",
                          in_words(static_cast<double>(n_rows)), name, bytes_in_words(n_rows * bytes_each),
                          bytes_in_words(free), in_words(static_cast<double>(most - most / 5))));
}

void check_rays_fit(std::uint64_t n_rays, std::uint64_t free) {
  check_rows_fit("rays", n_rays, kRayBytes, free);
}

}  // namespace kdray::cli
