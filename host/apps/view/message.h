// What    The page's messages, checked: every field of its type and in its range, and no unknown field.
// Shape   JSON texts of at most kMostText bytes. The page's own numbers (of looks, frames, picks) come back
//         in what answers them.
// Errors  kdray::Error, ErrorCode::input, which is sent to the page and ends its connection.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <variant>

#include "apps/view/view_request.h"

namespace kdray::view {

inline constexpr std::size_t kMostText = 4096;
inline constexpr int kMostSide = 4096;
inline constexpr int kMostPixels = 8 << 20;
inline constexpr int kMostCellDepth = 24;

// What the page wants to show now; `moving`: more looks follow at once.
struct Look {
  std::uint32_t number = 0;
  bool moving = false;
  ViewRequest request;
};
// The frame is on the screen.
struct Shown {
  std::uint32_t frame = 0;
};
// What is at a point of the picture, in shares of its width and height.
struct Pick {
  std::uint32_t number = 0;
  double x = 0, y = 0;
  ViewRequest request;
};
// The tree's cells to a depth; 0: none.
struct Cells {
  std::size_t scene = 0;
  int depth = 0;
};
// To open the scene again with normals for triangles that have none, where the surface turns by no more
// degrees than so many; 0: without.
struct Smooth {
  std::size_t scene = 0;
  double degrees = 0;
};
using Message = std::variant<Look, Shown, Pick, Cells, Smooth>;

Message parse_message(std::string_view text);

// Returns the token in a first message, {"type": "hello", "token": "..."}; it may be empty.
std::string token_of_hello(std::string_view text);

}  // namespace kdray::view
