// The order of a tile's pixels: each exactly once, whatever the tile's sides, in less than four times as many
// places; and sixteen places in a row are 4x4 pixels where the tile is as large as that.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "support/device.h"
#include "support/run_kernel.h"

namespace kdray {
namespace {

struct Query {
  cl_uint width, height, place;
};
struct Pixel {
  cl_uint x, y;
  cl_uint bits;  // the tile has 2^bits places
  bool operator==(const Pixel&) const = default;
};

class PlaceTest : public test::EachDevice {
 protected:
  std::vector<Pixel> pixels_at(const std::vector<Query>& places) {
    return test::run_kernel<Pixel>(GetParam(), R"(#include "raygen/place.clh"
typedef struct Query { uint width, height, place; } Query;
typedef struct Pixel { uint x, y, bits; } Pixel;
__kernel void test(__global const Query* in, __global Pixel* out, uint n) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const TileOrder order = tile_order(in[i].width, in[i].height);
  uint16 x, y;
  place_to_pixel(order, (uint16)(in[i].place), &x, &y);
  const Pixel pixel = {x.s5, y.s5, (uint)(63 - clz(order.n_places))};
  out[i] = pixel;
}
)",
                                   places);
  }

  std::vector<Pixel> all_of(cl_uint width, cl_uint height) {
    std::vector<Query> places(std::size_t{1} << pixels_at({{width, height, 0}})[0].bits);
    for (cl_uint i = 0; i < places.size(); ++i) places[i] = {width, height, i};
    return pixels_at(places);
  }
};

TEST_P(PlaceTest, EveryPixelOnce) {
  const std::pair<cl_uint, cl_uint> tiles[] = {{1, 1},   {1, 7},   {2, 1},  {5, 17},  {16, 16},
                                               {31, 33}, {32, 32}, {64, 3}, {1000, 9}};
  for (const auto& [width, height] : tiles) {
    SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height));
    const std::vector<Pixel> pixels = all_of(width, height);
    EXPECT_LT(pixels.size(), 4u * width * height);
    std::set<std::pair<cl_uint, cl_uint>> inside;
    for (const Pixel& p : pixels) {
      if (p.x >= width || p.y >= height) continue;
      EXPECT_TRUE(inside.insert({p.x, p.y}).second) << p.x << " " << p.y;
    }
    EXPECT_EQ(inside.size(), std::size_t{width} * height);
  }
}

TEST_P(PlaceTest, SixteenInARowAreFourByFour) {
  const std::pair<cl_uint, cl_uint> tiles[] = {{32, 32}, {64, 16}, {4, 8}};
  for (const auto& [width, height] : tiles) {
    const std::vector<Pixel> pixels = all_of(width, height);
    for (std::size_t i = 0; i < pixels.size(); i += 16)
      for (std::size_t k = 0; k < 16; ++k) {
        ASSERT_EQ(pixels[i + k].x / 4, pixels[i].x / 4) << i;
        ASSERT_EQ(pixels[i + k].y / 4, pixels[i].y / 4) << i;
      }
  }
}

// 2^31 pixels are the most; their places may need all 32 bits.
TEST_P(PlaceTest, TheLargestTiles) {
  const std::vector<Pixel> wanted = {{65535, 32767, 31}, {65535, 65535, 32}, {65535, 0, 16}};
  EXPECT_EQ(pixels_at({{65536, 32768, 0x7fffffffu}, {46341, 46341, 0xffffffffu}, {65536, 1, 65535}}), wanted);
}

KDRAY_FOR_EACH_DEVICE(PlaceTest);

}  // namespace
}  // namespace kdray
