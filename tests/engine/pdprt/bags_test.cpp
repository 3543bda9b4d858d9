// Who lends to whom: every rank but the first borrows from one, which knows of it; nobody has many to answer;
// a message passes two hands at most; and what is fed by way of each rank adds up.
#include "engine/pdprt/bags.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace kdray::pdprt {
namespace {

int n_hands(const Bags& bags, int rank) {
  int n = 0;
  for (; rank != 0; rank = bags.lender_of(rank)) ++n;
  return n;
}

void check(int n, const Bags& bags) {
  std::vector<int> lenders(static_cast<std::size_t>(n), -1);
  for (int rank = 0; rank < n; ++rank) {
    int n_fed = 1;
    for (const int borrower : bags.borrowers_of(rank)) {
      ASSERT_GT(borrower, rank);
      ASSERT_LT(borrower, n);
      ASSERT_EQ(lenders[static_cast<std::size_t>(borrower)], -1) << "two lenders of " << borrower;
      lenders[static_cast<std::size_t>(borrower)] = rank;
      n_fed += bags.n_fed_by(borrower);
    }
    ASSERT_EQ(bags.n_fed_by(rank), n_fed) << rank;
  }
  for (int rank = 1; rank < n; ++rank) {
    ASSERT_EQ(bags.lender_of(rank), lenders[static_cast<std::size_t>(rank)]) << rank;
    ASSERT_TRUE(bags.lends_to(bags.lender_of(rank), rank));
    ASSERT_FALSE(bags.lends_to(rank, rank));
    ASSERT_LE(n_hands(bags, rank), 2);
  }
  ASSERT_FALSE(bags.lends_to(0, 0));
}

TEST(Bags, EveryRankHasOneLender) {
  for (int n = 1; n <= 300; ++n)
    for (const int most : {1, 2, 7, 64, 1000}) {
      SCOPED_TRACE(testing::Message() << n << " ranks, " << most << " to a bag");
      check(n, Bags(n, most));
      if (HasFatalFailure()) return;
    }
}

TEST(Bags, FewRanksShareOne) {
  const Bags bags(64);
  EXPECT_EQ(bags.borrowers_of(0).size(), 63u);
  EXPECT_TRUE(bags.borrowers_of(8).empty());
}

TEST(Bags, NobodyOfManyHasManyToAnswer) {
  const Bags bags(10000);
  std::size_t most = 0;
  for (int rank = 0; rank < 10000; ++rank) most = std::max(most, bags.borrowers_of(rank).size());
  EXPECT_EQ(most, 198u);  // a hundred in each group, and as many groups
}

}  // namespace
}  // namespace kdray::pdprt
