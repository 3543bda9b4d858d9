// What    The depths that are tried begin at a lone leaf, hold the usual one, and end within the traversal's
//         stack.
#include "bench/build/bench.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace kdray::bench {
namespace {

TEST(Depths, GoBeyondTheUsualOne) {
  EXPECT_EQ(depths_to_try(5), (std::vector<int>{0, 2, 4, 5, 9, 13}));
  EXPECT_EQ(depths_to_try(8), (std::vector<int>{0, 2, 4, 6, 8, 12, 16}));
}

TEST(Depths, EndWithTheStack) {
  const std::vector<int> depths = depths_to_try(62);
  EXPECT_EQ(depths.back(), 62);
  EXPECT_TRUE(std::is_sorted(depths.begin(), depths.end()));
}

}  // namespace
}  // namespace kdray::bench
