// What    Frames of random sizes, for tests without a device.
#pragma once

#include <cstdint>
#include <random>

#include "layout/frame.layout.h"

namespace kdray::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : random_(seed) {}
  std::uint32_t pick(std::uint32_t least, std::uint32_t most) {
    return least + static_cast<std::uint32_t>(random_() % (most - least + 1));
  }
  layout::i64 sum() { return static_cast<layout::i64>(random_()) >> 24; }

 private:
  std::mt19937_64 random_;
};

inline layout::Frame random_frame(Random& random) {
  layout::Frame frame{};
  frame.width = random.pick(1, 90), frame.height = random.pick(1, 70);
  frame.tile_width = random.pick(1, 32), frame.tile_height = random.pick(1, 32);
  frame.n_samples = random.pick(1, 4);
  frame.n_tiles_x = (frame.width + frame.tile_width - 1) / frame.tile_width;
  frame.n_tiles = frame.n_tiles_x * ((frame.height + frame.tile_height - 1) / frame.tile_height);
  return frame;
}

}  // namespace kdray::test
