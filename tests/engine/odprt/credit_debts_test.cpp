// Credits that go from rank to rank: there are never more nor fewer than there were, they go back to where
// they came from, and a rank without any gets some.
#include "engine/odprt/ray_credits.h"

#include <gtest/gtest.h>

#include <numeric>

namespace kdray::odprt {
namespace {

using Counts = std::vector<std::uint32_t>;

TEST(CreditDebtsTest, SharesAreTheWhole) {
  for (std::uint32_t ranks = 1; ranks <= 7; ++ranks) {
    Counts sum(6);
    for (std::uint32_t rank = 0; rank < ranks; ++rank) {
      const Counts own = RayCredits(2, {10, 7, 1}, {1, 1, 1}, 1, {rank, ranks}).spare();
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += own[i];
    }
    EXPECT_EQ(sum, (Counts{10, 7, 1, 10, 7, 1}));
  }
}

TEST(CreditDebtsTest, RaysBringTheirCreditsAlong) {
  RayCredits from(1, {8, 8}, {1, 1}, 1, {0, 2}), to(1, {8, 8}, {1, 1}, 1, {1, 2});
  std::vector<layout::Credits> credits(1);
  from.grant(0, credits);
  EXPECT_EQ(credits[0].rays[1], 4u);
  std::vector<layout::Traffic> traffic(1);
  traffic[0] = {};
  traffic[0].made[1] = 3;
  from.settle(0, traffic);
  EXPECT_EQ(from.alive(), 3u);
  from.depart(Counts{0, 3});
  to.arrive(Counts{0, 3});
  EXPECT_EQ(from.alive(), 0u);
  EXPECT_EQ(to.alive(), 3u);
  EXPECT_EQ(from.spare(), (Counts{4, 1}));
  EXPECT_EQ(to.spare(), (Counts{4, 4}));
  to.grant(0, credits);
  traffic[0] = {};
  traffic[0].ended[1] = 3;
  to.settle(0, traffic);
  EXPECT_EQ(to.spare(), (Counts{4, 7}));
}

TEST(CreditDebtsTest, GoBackToWhereTheyCameFrom) {
  CreditDebts debts(3, 1, {0, 2});
  debts.came(1, Counts{5, 9});
  debts.came(2, Counts{1, 0});
  EXPECT_EQ(debts.due(1, Counts{4, 8}, 1), (Counts{4, 6}));  // no more than there is, but for what is kept
  EXPECT_EQ(debts.due(1, Counts{4, 1}, 1), (Counts{4, 0}));
  EXPECT_TRUE(debts.due(1, Counts{4, 6}, 11).empty());  // not worth a message
  EXPECT_TRUE(debts.due(0, Counts{4, 6}, 1).empty());
  debts.went(1, Counts{5, 9});
  EXPECT_TRUE(debts.due(1, Counts{9, 9}, 1).empty());
  EXPECT_EQ(debts.due(2, Counts{9, 9}, 1), (Counts{1, 0}));
}

TEST(CreditDebtsTest, HalfWhereBothHaveEnoughThen) {
  EXPECT_EQ(half_of(Counts{4, 3, 9, 0}, Counts{2, 2}), (Counts{2, 0, 4, 0}));
  EXPECT_EQ(half_of(Counts{1, 0}, Counts{0, 0}), (Counts{0, 0}));
}

}  // namespace
}  // namespace kdray::odprt
