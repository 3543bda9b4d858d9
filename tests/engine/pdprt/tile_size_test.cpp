// Tiles get smaller for small pictures, many compute units, and where one tile was a large part of the work.
#include "engine/pdprt/tiles.h"

#include <gtest/gtest.h>

namespace kdray::pdprt {
namespace {

TEST(TileSize, SmallPicturesAndManyUnitsGetSmallTiles) {
  EXPECT_EQ(choose_tile_side(1024, 1024, 2, {}), 32u);
  EXPECT_EQ(choose_tile_side(256, 256, 2, {}), 16u);
  EXPECT_EQ(choose_tile_side(64, 64, 2, {}), 8u);
  EXPECT_EQ(choose_tile_side(1024, 1024, 64, {}), 16u);
  EXPECT_EQ(choose_tile_side(1, 1, 1, {}), 8u);
  EXPECT_EQ(choose_tile_side(16384, 16384, 64, {}), 32u);
}

TEST(TileSize, ACostlyTileIsCutUp) {
  const auto with = [](double costliest) {
    return choose_tile_side(1024, 1024, 2, TileCost{32 * 32, costliest, 1.0});
  };
  EXPECT_EQ(with(0.001), 32u);
  EXPECT_EQ(with(0.02), 16u);
  EXPECT_EQ(with(0.1), 8u);
  EXPECT_EQ(with(0.9), 8u);
}

// Otherwise sizes would change from frame to frame.
TEST(TileSize, ACostlyTileThatWasCutUpStaysSo) {
  EXPECT_EQ(choose_tile_side(1024, 1024, 2, TileCost{16 * 16, 0.005, 1.0}), 16u);
}

}  // namespace
}  // namespace kdray::pdprt
