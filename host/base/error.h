// What    kdray::Error for the modules (the class itself is public and lives in kdray/error.h), and for its
//         messages the known name that is nearest to an unknown one.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "kdray/error.h"

namespace kdray {

// ---- Suggestions for a name that is unknown

// Returns the name nearest to `word`, or nothing when none is near.
std::string_view nearest_name(std::string_view word, std::span<const std::string_view> names);

// Returns "did you mean 'radius'?", or nothing when no name is near.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> names);

}  // namespace kdray
