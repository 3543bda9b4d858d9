// What    What counts as another hit, and what as the same.
#include "bench/race/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace kdray::bench {
namespace {

constexpr Hit kMiss{std::numeric_limits<float>::infinity(), -1, 0, 0};
constexpr Hit kHit{2, 7, 0.25f, 0.5f};

double share(const Hit& a, const Hit& b) {
  return differing_share(std::vector{a}, std::vector{b});
}

TEST(CompareHits, IdenticalMeansEveryBit) {
  const std::vector<Hit> hits = {kMiss, kHit, kHit};
  EXPECT_EQ(count_not_identical(hits, hits), 0u);
  std::vector<Hit> other = hits;
  other[1].u = std::nextafter(other[1].u, 1.0f);
  other[0].v = -0.0f;
  EXPECT_EQ(count_not_identical(hits, other), 2u);
  other.pop_back();
  EXPECT_EQ(count_not_identical(hits, other), 3u);
}

TEST(CompareHits, AHitDiffersFromAMiss) {
  EXPECT_EQ(share(kHit, kMiss), 1);
  EXPECT_EQ(share(kMiss, kHit), 1);
  EXPECT_EQ(share(kMiss, kMiss), 0);
}

TEST(CompareHits, AnotherPrimitiveAtTheSameDistanceIsACommonEdge) {
  Hit neighbour = kHit;
  neighbour.primitive = 8;
  EXPECT_EQ(share(kHit, neighbour), 0);
  neighbour.t = 2.0001f;
  EXPECT_EQ(share(kHit, neighbour), 0);
  neighbour.t = 2.001f;
  EXPECT_EQ(share(kHit, neighbour), 1);
}

// Of scenes whose numbers mean different things: the same number tells nothing.
TEST(CompareHits, ByDistancesAlone) {
  Hit other = kHit;
  other.primitive = 8;
  const auto apart = [](const Hit& a, const Hit& b) {
    return differing_distances(std::vector{a}, std::vector{b});
  };
  EXPECT_EQ(apart(kHit, other), 0);
  EXPECT_EQ(apart(kHit, kMiss), 1);
  other = kHit;
  other.t = 2.001f;
  EXPECT_EQ(share(kHit, other), 0);
  EXPECT_EQ(apart(kHit, other), 1);
}

TEST(CompareHits, IsAShareOfAllRays) {
  const std::vector<Hit> a = {kHit, kHit, kMiss, kMiss}, b = {kHit, kMiss, kMiss, kMiss};
  EXPECT_EQ(differing_share(a, b), 0.25);
  EXPECT_EQ(differing_share({}, {}), 0);
}

}  // namespace
}  // namespace kdray::bench
