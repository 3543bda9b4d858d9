// What    Which rank serves tiles to which. Rank 0 has the bag of a list and serves all ranks; beyond 64 of
//         them some others have bags of their own, which they fill from rank 0's: bags of bags.
// Shape   `n` ranks are parted into groups of neighbours, about as many groups as there are ranks in each;
//         the first of a group serves the others, and is a client of rank 0, which serves its own group
//         too. So nobody has more than about twice the root of `n` to answer, and a message passes two hands
//         at most.
// Threads Any.
#pragma once

#include <cstddef>
#include <optional>
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

// When a rank asks for more tiles, and for how many: so early and so many that it never waits for them, and
// no earlier, since tiles that lie with one rank are lost to the others at the end. It asks while what lies
// ready is less than its queues take at a time, or than they render while a message goes there and back;
// both are measured. Seconds of any clock.
class PrefetchPolicy {
 public:
  // How many tiles are worth a message, if one is to be sent now. `stock`: what lies ready; `usual`: what is
  // taken of it at a time; `in_work`: what was taken, and may not be done.
  std::optional<std::size_t> ask(std::size_t stock, std::size_t usual, std::size_t in_work, double now);

  void granted(std::size_t n, double now);

 private:
  std::size_t during(double seconds, std::size_t not_done, double now) const;

  bool asked_ = false, any_ = false;
  double asked_at_ = 0, since_ = 0;
  double round_trip_ = 0.002;  // until it is measured
  std::size_t n_granted_ = 0;
};

}  // namespace kdray::pdprt
