// The order of a picture's pixels: each once, block by block, four by four in sixteen; blocks know their
// neighbours.
#include "engine/adaptive/blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace kdray::adaptive {
namespace {

TEST(Blocks, EveryPixelOnce) {
  for (const Size size : {Size{1, 1}, {32, 32}, {33, 31}, {100, 7}, {5, 200}}) {
    const Blocks blocks(size);
    std::vector<int> times(size.pixels());
    for (std::size_t block = 0; block < blocks.count(); ++block)
      blocks.for_each(block, [&](std::size_t pixel, std::uint32_t x, std::uint32_t y) {
        EXPECT_EQ(pixel, std::size_t{y} * size.width + x);
        ++times[pixel];
      });
    EXPECT_EQ(std::count(times.begin(), times.end(), 1), static_cast<std::ptrdiff_t>(size.pixels()));
  }
}

TEST(Blocks, SixteenInARowAreFourByFour) {
  const Blocks blocks({64, 64});
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pixels;
  blocks.for_each(2, [&](std::size_t, std::uint32_t x, std::uint32_t y) { pixels.emplace_back(x, y); });
  ASSERT_EQ(pixels.size(), 1024u);
  for (std::size_t first = 0; first < pixels.size(); first += 16)
    for (std::size_t i = first; i < first + 16; ++i) {
      EXPECT_EQ(pixels[i].first / 4, pixels[first].first / 4);
      EXPECT_EQ(pixels[i].second / 4, pixels[first].second / 4);
    }
}

TEST(Blocks, AroundIsMutualAndThreeByThree) {
  const Blocks blocks({100, 70});  // 4 x 3
  std::size_t pairs = 0;
  for (std::size_t block = 0; block < blocks.count(); ++block) {
    const auto around = blocks.around(block);
    EXPECT_EQ(std::set(around.begin(), around.end()).size(), around.size());
    EXPECT_EQ(std::count(around.begin(), around.end(), block), 1);
    for (const std::size_t other : around) {
      const auto back = blocks.around(other);
      EXPECT_EQ(std::count(back.begin(), back.end(), block), 1);
    }
    pairs += around.size();
  }
  EXPECT_EQ(pairs, (2u * 2 + 2 * 3) * (2 * 2 + 3));  // columns' by rows' neighbours, 4 x 3
}

}  // namespace
}  // namespace kdray::adaptive
