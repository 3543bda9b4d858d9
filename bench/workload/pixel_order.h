// What    The order in which rays through a picture's pixels are made: along Morton's curve, which keeps
//         neighbours together in both directions, or line by line.
// Source  G. M. Morton, "A computer oriented geodetic data base", IBM 1966: the bits of x and y interleaved.
#pragma once

#include <vector>

namespace kdray::bench {

struct Pixel {
  int x, y;
  bool operator==(const Pixel&) const = default;
};

// Every pixel of a side x side picture once.
std::vector<Pixel> morton_order(int side);
std::vector<Pixel> scanline_order(int side);

}  // namespace kdray::bench
