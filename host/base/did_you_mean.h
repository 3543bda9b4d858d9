// What    A suggestion for a name that is unknown: the one nearest to it of those that there are.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace kdray {

// The name nearest to `word`, or nothing when none is near.
std::string_view nearest_name(std::string_view word, std::span<const std::string_view> names);

// "did you mean 'radius'?", or nothing when none is near.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> names);

}  // namespace kdray
