// What    The events of the plane sweep: where references end, lie and start along an axis, as sortable
//         integers.
// Shape   The order of float positions is kept by the upper bits, the kind of the event by the lowest two: at
//         one position ends come first, then planar references, then starts.
// Source  Wald and Havran 2006, section 4.2.
#pragma once

#include <bit>
#include <cstdint>

namespace kdray::kdtree {

using Event = std::uint64_t;
enum class EventKind : std::uint32_t { end = 0, planar = 1, start = 2 };

inline Event make_event(float position, EventKind kind) {
  // + 0 turns -0 into 0: they are one plane.
  const auto bits = std::bit_cast<std::uint32_t>(position + 0.0f);
  const std::uint32_t ordered = bits & 0x80000000u ? ~bits : bits | 0x80000000u;
  return static_cast<Event>(ordered) << 2 | static_cast<std::uint32_t>(kind);
}

inline EventKind kind_of(Event e) {
  return static_cast<EventKind>(e & 3u);
}

inline float position_of(Event e) {
  const auto ordered = static_cast<std::uint32_t>(e >> 2);
  return std::bit_cast<float>(ordered & 0x80000000u ? ordered & 0x7fffffffu : ~ordered);
}

}  // namespace kdray::kdtree
