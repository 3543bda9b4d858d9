// The curve visits every tile of a rectangle once, going from neighbour to neighbour.
#include "engine/wavefront/tile_order.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

namespace kdray::pdprt {
namespace {

int column(layout::u32 tile) {
  return static_cast<int>(KDRAY_TILE_COLUMN(tile));
}
int row(layout::u32 tile) {
  return static_cast<int>(KDRAY_TILE_ROW(tile));
}

TEST(Curve, VisitsEveryTileOnceAndNeighboursInTurn) {
  for (std::uint32_t columns = 1; columns <= 40; ++columns) {
    for (std::uint32_t rows = 1; rows <= 40; ++rows) {
      SCOPED_TRACE(std::to_string(columns) + "x" + std::to_string(rows));
      const std::vector<layout::u32> curve = wavefront::tile_curve(columns, 7, rows);
      ASSERT_EQ(curve.size(), std::size_t{columns} * rows);
      EXPECT_EQ(std::set<layout::u32>(curve.begin(), curve.end()).size(), curve.size());
      int diagonal = 0;
      for (std::size_t i = 0; i < curve.size(); ++i) {
        EXPECT_LT(KDRAY_TILE_COLUMN(curve[i]), columns);
        EXPECT_GE(KDRAY_TILE_ROW(curve[i]), 7u);
        EXPECT_LT(KDRAY_TILE_ROW(curve[i]), 7 + rows);
        if (i == 0) continue;
        const int dx = std::abs(column(curve[i]) - column(curve[i - 1]));
        const int dy = std::abs(row(curve[i]) - row(curve[i - 1]));
        EXPECT_LE(std::max(dx, dy), 1);
        diagonal += dx + dy == 2;
      }
      EXPECT_LE(diagonal, 1);
    }
  }
}

// What it is for: a quarter of the curve lies in a quarter of the picture, not in a stripe across it.
TEST(Curve, PartsLieTogether) {
  const std::vector<layout::u32> curve = wavefront::tile_curve(32, 0, 32);
  for (std::size_t part = 0; part < 4; ++part) {
    int lo_x = 32, hi_x = 0, lo_y = 32, hi_y = 0;
    for (std::size_t i = part * 256; i < (part + 1) * 256; ++i) {
      lo_x = std::min(lo_x, column(curve[i])), hi_x = std::max(hi_x, column(curve[i]));
      lo_y = std::min(lo_y, row(curve[i])), hi_y = std::max(hi_y, row(curve[i]));
    }
    EXPECT_EQ(hi_x - lo_x, 15);
    EXPECT_EQ(hi_y - lo_y, 15);
  }
}

TEST(Curve, LongAndThinTakesNoLonger) {
  EXPECT_EQ(wavefront::tile_curve(65536, 0, 1).size(), 65536u);
  EXPECT_EQ(wavefront::tile_curve(1, 0, 65536).back(), KDRAY_TILE(0u, 65535u));
}

}  // namespace
}  // namespace kdray::pdprt
