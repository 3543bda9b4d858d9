// What    Letters for a picture's legend: 5 by 7 dots each, drawn larger by a whole factor.
// Shape   Small letters, digits and ",.:-()"; capitals are drawn small, anything else is a blank.
#pragma once

#include <string_view>

#include "film/image.h"

namespace kdray::verify {

inline constexpr int kLetterWidth = 6, kLetterHeight = 9;  // with the gap to the next

// The text's upper left corner at (x, y). What lies outside of the picture is left out.
void draw_text(film::Image& image, int x, int y, int factor, std::string_view text, const vec3& color);

}  // namespace kdray::verify
