// Which rank serves which: every rank but the first has one server, which knows of it; nobody has many to
// answer; a message passes two hands at most; and the counts of ranks served by way of each rank add up.
#include "engine/pdprt/tile_hierarchy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace kdray::pdprt {
namespace {

int n_hands(const TileHierarchy& hierarchy, int rank) {
  int n = 0;
  for (; rank != 0; rank = hierarchy.server_of(rank)) ++n;
  return n;
}

void check(int n, const TileHierarchy& hierarchy) {
  std::vector<int> servers(static_cast<std::size_t>(n), -1);
  for (int rank = 0; rank < n; ++rank) {
    int n_served = 1;
    for (const int client : hierarchy.clients_of(rank)) {
      ASSERT_GT(client, rank);
      ASSERT_LT(client, n);
      ASSERT_EQ(servers[static_cast<std::size_t>(client)], -1) << "two servers of " << client;
      servers[static_cast<std::size_t>(client)] = rank;
      n_served += hierarchy.n_served_by(client);
    }
    ASSERT_EQ(hierarchy.n_served_by(rank), n_served) << rank;
  }
  for (int rank = 1; rank < n; ++rank) {
    ASSERT_EQ(hierarchy.server_of(rank), servers[static_cast<std::size_t>(rank)]) << rank;
    ASSERT_TRUE(hierarchy.serves(hierarchy.server_of(rank), rank));
    ASSERT_FALSE(hierarchy.serves(rank, rank));
    ASSERT_LE(n_hands(hierarchy, rank), 2);
  }
  ASSERT_FALSE(hierarchy.serves(0, 0));
}

TEST(TileHierarchy, EveryRankHasOneServer) {
  for (int n = 1; n <= 300; ++n)
    for (const int most : {1, 2, 7, 64, 1000}) {
      SCOPED_TRACE(testing::Message() << n << " ranks, " << most << " to a bag");
      check(n, TileHierarchy(n, most));
      if (HasFatalFailure()) return;
    }
}

TEST(TileHierarchy, FewRanksShareOne) {
  const TileHierarchy hierarchy(64);
  EXPECT_EQ(hierarchy.clients_of(0).size(), 63u);
  EXPECT_TRUE(hierarchy.clients_of(8).empty());
}

TEST(TileHierarchy, NobodyOfManyHasManyToAnswer) {
  const TileHierarchy hierarchy(10000);
  std::size_t most = 0;
  for (int rank = 0; rank < 10000; ++rank) most = std::max(most, hierarchy.clients_of(rank).size());
  EXPECT_EQ(most, 198u);  // a hundred in each group, and as many groups
}

}  // namespace
}  // namespace kdray::pdprt
