#include "device/opencl/variant.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>

namespace kdray::device {

std::string options_with(const std::string& options, std::uint64_t mask) {
  return fmt::format("{} -DKDRAY_FEATURES={:#018x}ul", options, mask);
}

bool covers(std::uint64_t mask, const Variant& wanted) {
  return (mask & wanted.mask) == wanted.mask && (mask & ~wanted.mask & ~wanted.spare) == 0;
}

std::vector<std::uint64_t> covering(std::vector<std::uint64_t> masks, const Variant& wanted) {
  std::erase_if(masks, [&](std::uint64_t mask) { return !covers(mask, wanted); });
  std::ranges::sort(masks, {}, [](std::uint64_t mask) { return std::pair(std::popcount(mask), mask); });
  return masks;
}

}  // namespace kdray::device
