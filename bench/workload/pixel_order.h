// What    The order in which rays through a picture's pixels are made: along Morton's curve, which keeps
//         neighbours together in both directions, or line by line. Every pixel of a side x side picture once.
// Source  G. M. Morton, "A computer oriented geodetic data base", IBM 1966: the bits of x and y interleaved.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

namespace kdray::bench {

struct Pixel {
  int x, y;
  bool operator==(const Pixel&) const = default;
};

inline std::vector<Pixel> scanline_order(int side) {
  std::vector<Pixel> pixels;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) pixels.push_back({x, y});
  return pixels;
}

// The even bits of a place along the curve, moved together.
inline int even_bits(std::uint64_t place) {
  int bits = 0;
  for (int i = 0; place >> (2 * i) != 0; ++i) bits |= static_cast<int>(place >> (2 * i) & 1) << i;
  return bits;
}

// The curve fills a square whose side is a power of two; what lies outside the picture is passed over.
inline std::vector<Pixel> morton_order(int side) {
  std::vector<Pixel> pixels;
  const std::uint64_t square = std::bit_ceil(static_cast<std::uint64_t>(side));
  for (std::uint64_t place = 0; place < square * square; ++place) {
    const Pixel p{even_bits(place), even_bits(place >> 1)};
    if (p.x < side && p.y < side) pixels.push_back(p);
  }
  return pixels;
}

}  // namespace kdray::bench
