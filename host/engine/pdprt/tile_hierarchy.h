// What    Which rank serves tiles to which. Rank 0 has the bag of a list and serves all ranks; beyond 64 of
//         them some others have bags of their own, which they fill from rank 0's: bags of bags.
// Shape   `n` ranks are parted into groups of neighbours, about as many groups as there are ranks in each;
//         the first of a group serves the others, and is a client of rank 0, which serves its own group
//         too. So nobody has more than about twice the root of `n` to answer, and a message passes two hands
//         at most.
// Threads Any.
#pragma once

#include <vector>

namespace kdray::pdprt {

// So many ask one rank without waiting for each other: an answer takes it some 0.1 ms, and a rank asks some
// ten times a second.
inline constexpr int kRanksToABag = 64;

class TileHierarchy {
 public:
  explicit TileHierarchy(int n_ranks, int ranks_to_a_bag = kRanksToABag);

  // Of every rank but 0.
  int server_of(int rank) const { return rank % group_ == 0 ? 0 : rank - rank % group_; }
  bool serves(int server, int rank) const { return rank != 0 && server_of(rank) == server; }
  std::vector<int> clients_of(int rank) const;  // in order
  // How many ranks get their tiles by way of this one, which is one of them.
  int n_served_by(int rank) const;

 private:
  int n_ranks_, group_;  // of one rank each: rank 0 serves all
};

}  // namespace kdray::pdprt
