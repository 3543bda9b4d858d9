// What    Triangles, boxes and planes with small integer coordinates, about an offset and times a power of
//         two: exact as floats and as integers.
#pragma once

#include "accel/kdtree/exact_clip.h"
#include "accel/kdtree/reference.h"
#include "accel/kdtree/shapes.h"

namespace kdray::test {

// A triangle, a box and a plane inside it.
struct IntegerCase {
  std::array<Point, 3> triangle;
  Point lo, hi;
  int axis;
  std::int64_t plane;
};

inline IntegerCase random_case(Random& random, int size) {
  const auto whole = [&] { return static_cast<std::int64_t>(random() % (2 * size + 1)) - size; };
  IntegerCase c;
  for (Point& p : c.triangle) p = {whole(), whole(), whole()};
  if (random() % 4 == 0) {  // axis-aligned
    const int k = static_cast<int>(random() % 3);
    c.triangle[1][k] = c.triangle[2][k] = c.triangle[0][k];
  }
  for (int k = 0; k < 3; ++k) {
    const std::int64_t a = whole(), b = whole();
    c.lo[k] = std::min(a, b), c.hi[k] = std::max(a, b);
    if (random() % 2 == 0) c.lo[k] = -size, c.hi[k] = size;
  }
  c.axis = static_cast<int>(random() % 3);
  const std::int64_t length = c.hi[c.axis] - c.lo[c.axis];
  c.plane = c.lo[c.axis] + (length > 0 ? static_cast<std::int64_t>(random() % (length + 1)) : 0);
  return c;
}

// Integer coordinates about an offset, times a power of two: still exact floats.
inline float to_float(std::int64_t x, float offset, float scale) {
  return (static_cast<float>(x) + offset) * scale;
}

inline kdtree::Bounds to_bounds(const Point& lo, const Point& hi, float offset, float scale) {
  kdtree::Bounds b;
  for (int k = 0; k < 3; ++k) {
    b.lo[k] = to_float(lo[k], offset, scale);
    b.hi[k] = to_float(hi[k], offset, scale);
  }
  return b;
}

// bound - f, exact in its sign: all of it has fewer than 64 bits.
inline long double excess(float bound, const Fraction& f, float offset, float scale) {
  const long double b = static_cast<long double>(bound) / scale - offset;
  return (b * f.denominator - f.numerator) / f.denominator;
}

}  // namespace kdray::test
