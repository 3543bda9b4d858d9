// What    Who lends tiles to whom. Rank 0 has the bag of a list; ranks borrow from it, and beyond 64 of them
//         from some that have bags of their own, which they fill at rank 0's: bags of bags.
// Shape   `n` ranks are parted into groups of neighbours, about as many groups as there are ranks in each;
//         the first of a group lends to the others, and borrows from rank 0, which lends to its own group
//         too. So nobody has more than about twice the root of `n` to answer, and a message passes two hands
//         at most.
// Threads Any.
#pragma once

#include <vector>

namespace kdray::pdprt {

// So many ask one rank without waiting for each other: an answer takes it some 0.1 ms, and a rank asks some
// ten times a second.
inline constexpr int kRanksToABag = 64;

class Bags {
 public:
  explicit Bags(int n_ranks, int ranks_to_a_bag = kRanksToABag);

  // Of every rank but 0.
  int lender_of(int rank) const { return rank % group_ == 0 ? 0 : rank - rank % group_; }
  bool lends_to(int lender, int rank) const { return rank != 0 && lender_of(rank) == lender; }
  std::vector<int> borrowers_of(int rank) const;  // in order
  // How many ranks get their tiles by way of this one, which is one of them.
  int n_fed_by(int rank) const;

 private:
  int n_ranks_, group_;  // of one rank each: all borrow from rank 0
};

}  // namespace kdray::pdprt
