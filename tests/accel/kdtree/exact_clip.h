// What    The exact bounds of the part of a triangle inside a box, in rational arithmetic.
// Shape   Integer coordinates of at most 2^10 in size about any common offset: every corner of the part is
//         one of three kinds (a vertex, an edge in a face's plane, an edge of the box in the triangle's
//         plane), each a single fraction, so 64 bits are exact.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace kdray::test {

using Point = std::array<std::int64_t, 3>;

struct Fraction {
  std::int64_t numerator = 0, denominator = 1;  // denominator > 0
};
bool operator<(const Fraction& a, const Fraction& b);

struct ExactBounds {
  std::array<Fraction, 3> lo, hi;
};

// Returns nothing when the triangle and the closed box have no point in common. The triangle must not be
// degenerate.
std::optional<ExactBounds> exact_clip(const std::array<Point, 3>& triangle, const Point& lo, const Point& hi);

}  // namespace kdray::test
