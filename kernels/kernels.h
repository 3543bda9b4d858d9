// What    The kernel sources, embedded in the program by embed.cmake.
#pragma once

#include <span>
#include <string_view>

namespace kdray::kernels {

struct Source {
  std::string_view name;  // as it is included: "traverse/closest.clh"
  std::string_view text;
};

std::span<const Source> sources();

}  // namespace kdray::kernels
