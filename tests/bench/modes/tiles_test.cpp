// What    Simulated PDPRT, where the answer is known: equal tiles, one heavy tile, a bag that is far away or
//         slow.
#include "bench/modes/tiles.h"

#include <gtest/gtest.h>

namespace kdray::bench {
namespace {

const std::vector<double> kEqual(64, 0.5);

TEST(SimulatedTiles, EqualOnesKeepQueuesBusyUntilThereAreFewer) {
  for (const std::uint32_t n : {1u, 2u, 8u, 64u}) {
    const double perfect = 32.0 / n;
    EXPECT_DOUBLE_EQ(contiguous_seconds(kEqual, n), perfect);
    EXPECT_DOUBLE_EQ(interleaved_seconds(kEqual, n), perfect);
    EXPECT_DOUBLE_EQ(bag_seconds(kEqual, n, {}), perfect);
  }
  for (const std::uint32_t n : {100u, 10000u}) {
    EXPECT_DOUBLE_EQ(contiguous_seconds(kEqual, n), 0.5);
    EXPECT_DOUBLE_EQ(interleaved_seconds(kEqual, n), 0.5);
    EXPECT_DOUBLE_EQ(bag_seconds(kEqual, n, {}), 0.5);
  }
}

TEST(SimulatedTiles, OneHalfOfThePictureIsHeavier) {
  std::vector<double> tiles(64, 1.0);
  std::fill(tiles.begin(), tiles.begin() + 32, 3.0);
  EXPECT_DOUBLE_EQ(contiguous_seconds(tiles, 2), 96);
  EXPECT_DOUBLE_EQ(interleaved_seconds(tiles, 2), 64);
  EXPECT_DOUBLE_EQ(bag_seconds(tiles, 2, {}), 64);
}

TEST(SimulatedTiles, AHeavyTileIsTheLeastThatItTakes) {
  std::vector<double> tiles(64, 1.0);
  tiles[63] = 100;
  EXPECT_DOUBLE_EQ(bag_seconds(tiles, 63, {}), 101);  // every queue has had one before
  std::swap(tiles[0], tiles[63]);
  EXPECT_DOUBLE_EQ(bag_seconds(tiles, 63, {}), 100);
}

TEST(SimulatedTiles, AnEarlyRequestHidesTheWay) {
  // The first tile comes after request and answer; the others have been asked for early enough.
  EXPECT_DOUBLE_EQ(bag_seconds(std::vector<double>(10, 1.0), 1, {0.25, 0}), 0.5 + 10);
  // A way longer than a tile keeps the queue waiting: one tile for each way.
  EXPECT_DOUBLE_EQ(bag_seconds(std::vector<double>(10, 1.0), 1, {2, 0}), 10 * 4 + 1);
}

TEST(SimulatedTiles, ABagServesOneAfterAnother) {
  // 64 queues ask at once; the last of them is served last.
  EXPECT_DOUBLE_EQ(bag_seconds(kEqual, 64, {0, 0.25}), 64 * 0.25 + 0.5);
}

TEST(TileSizes, KeepTheSumDownToOneTile) {
  const auto sizes = tile_sizes(kEqual);
  ASSERT_EQ(sizes.size(), 4u);  // 64, 16, 4, 1
  EXPECT_EQ(sizes[1], std::vector<double>(16, 2.0));
  EXPECT_EQ(sizes[3], std::vector<double>(1, 32.0));
  EXPECT_EQ(tile_sizes(std::vector<double>(6, 1.0))[1], (std::vector<double>{4, 2}));
}

}  // namespace
}  // namespace kdray::bench
