#include "bench/workload/pixel_order.h"

#include <bit>
#include <cstdint>

namespace kdray::bench {

namespace {

// The even bits of a word, moved together.
std::uint32_t even_bits(std::uint64_t code) {
  std::uint64_t x = code & 0x5555555555555555u;
  x = (x | (x >> 1)) & 0x3333333333333333u;
  x = (x | (x >> 2)) & 0x0f0f0f0f0f0f0f0fu;
  x = (x | (x >> 4)) & 0x00ff00ff00ff00ffu;
  x = (x | (x >> 8)) & 0x0000ffff0000ffffu;
  x = (x | (x >> 16)) & 0x00000000ffffffffu;
  return static_cast<std::uint32_t>(x);
}

std::vector<Pixel> reserved(int side) {
  std::vector<Pixel> pixels;
  pixels.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  return pixels;
}

}  // namespace

// The curve fills a square whose side is a power of two; what lies outside the picture is passed over.
std::vector<Pixel> morton_order(int side) {
  std::vector<Pixel> pixels = reserved(side);
  const std::uint64_t square = std::bit_ceil(static_cast<std::uint64_t>(side));
  for (std::uint64_t code = 0; code < square * square; ++code) {
    const Pixel p{static_cast<int>(even_bits(code)), static_cast<int>(even_bits(code >> 1))};
    if (p.x < side && p.y < side) pixels.push_back(p);
  }
  return pixels;
}

std::vector<Pixel> scanline_order(int side) {
  std::vector<Pixel> pixels = reserved(side);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) pixels.push_back({x, y});
  return pixels;
}

}  // namespace kdray::bench
