// What    A colour for each queue, by which pictures tell who traced what.
// Source  The first seven are Okabe and Ito's ("Color Universal Design", 2008), which all eyes tell apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace kdray::image {

// What channel "queue" says where it is not the number of a queue.
inline constexpr float kNoQueue = -1;     // nothing was hit, or the tile was not traced by this process
inline constexpr float kEveryQueue = -2;  // all of them hold what was hit

// Red, green and blue as sRGB has them, 0 to 255.
std::array<std::uint8_t, 3> queue_color(std::size_t queue);

}  // namespace kdray::image
