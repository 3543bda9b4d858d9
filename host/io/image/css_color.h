// What    Colours as the web writes them: the names of CSS, "#rgb" and "#rrggbb".
// Units   The text is sRGB, as on a screen; the result is linear.
// Source  CSS Color Module Level 4, "Named Colors".
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "base/vec.h"

namespace kdray::image {

// Small and large letters are the same. Returns nothing for any other text, "transparent" among it.
std::optional<vec3> css_color(std::string_view text);

// The names, for suggestions.
std::vector<std::string_view> css_names();

}  // namespace kdray::image
