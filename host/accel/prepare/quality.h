// What    The names of the qualities that a tree is built with, as options, reports and statistics have them.
#pragma once

#include <array>
#include <string_view>

#include "kdray/options.h"

namespace kdray::prepare {

// The names come in the order of BuildQuality.
inline constexpr std::array<std::string_view, 3> kQualityNames = {"fast", "balanced", "best"};

constexpr std::string_view name_of(BuildQuality quality) {
  return kQualityNames[static_cast<std::size_t>(quality)];
}

}  // namespace kdray::prepare
