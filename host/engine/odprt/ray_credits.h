// What    How many rays are alive, for each slice and depth, over all queues; and how many each queue may
//         make.
// Shape   Level 0 is shadow rays on their way, level d rays of depth d. A level has a capacity for each
//         slice, and as many credits as that: a ray alive takes one. Before a launch a queue is granted a
//         share of those that are left, and gives back what it didn't use. In the launch what it ends adds to
//         its credits: what it makes less what it ends never exceeds what it was granted.
// Why     (1) A level's rays never exceed its capacity, so every queue's pool can hold all of them, and
//         receiving can't fail.
//         (2) Some queue can always go on: rays of the greatest depth that is alive make rays of a depth of
//             which none is, so all of its capacity can be granted; what other queues hold of it comes back
//             when their launches end. Shadow rays make nothing. So the deepest rays go, then those above.
//         (3) When every count is 0 and no queue has tiles left, the frame is done: nothing is on its way,
//             since a ray is counted from where it is made to where it ends.
// Ranks   Each has such counts, and begins with an equal share of the credits. A ray that goes to another
//         rank takes its credit along: there is one more there, and one less here. So the sum of all ranks'
//         credits is the capacity, whoever has how many of them, and (1) holds without anybody knowing all
//         counts; CreditDebts has how credits come back to where they are wanted, which (2) asks for.
// Threads The caller locks.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "layout/odprt.layout.h"

namespace kdray::odprt {

// Which of how many ranks this is.
struct RankOf {
  std::uint32_t rank = 0, ranks = 1;
};

class RayCredits {
 public:
  // `least` is what a queue is granted at a level at least, as far as that is left: what one ray may make.
  // `n_queues` of this rank.
  RayCredits(std::size_t n_slices, const std::vector<std::uint32_t>& capacity,
             std::vector<std::uint32_t> least, std::size_t n_queues, RankOf rank = {});

  // Grants what the slices may make in the queue's next launch.
  void grant(std::size_t queue, std::span<layout::Credits> credits);

  // Takes over what the launch made and ended, and takes its credits back.
  void settle(std::size_t queue, std::span<const layout::Traffic> traffic);

  std::uint64_t alive() const { return alive_total_; }

  // Rays that have gone to another rank, or come from one, with their credits.
  void depart(std::span<const std::uint32_t> counts);
  void arrive(std::span<const std::uint32_t> counts);

  // Credits that no ray has and no launch may want. Counts, like the others, by slice and level.
  std::vector<std::uint32_t> spare() const;
  void add_credits(std::span<const std::uint32_t> counts);
  void take_credits(std::span<const std::uint32_t> counts);  // of what is to spare

  // Counts how often something was granted or given back. A queue that had nothing to do need not look again
  // before it changes.
  std::uint64_t version() const { return version_; }

 private:
  std::size_t n_levels() const { return least_.size(); }
  std::size_t at(std::size_t slice, std::size_t level) const { return slice * n_levels() + level; }

  std::vector<std::uint32_t> least_;                      // by level
  std::vector<std::uint32_t> credits_, alive_, granted_;  // by slice and level
  std::vector<std::vector<std::uint32_t>> held_;          // by queue: its part of granted_
  std::size_t n_holding_ = 0;
  std::uint64_t alive_total_ = 0, version_ = 0;
};

// What a rank owes others of its credits: rays bring them along, and they go back to where they came from
// when the rays have ended. Counts are by slice and level.
class CreditDebts {
 public:
  // `kept` by level: what is not given back, since queues here are to have it at once when they want it.
  CreditDebts(std::size_t n_ranks, std::size_t n_slices, std::vector<std::uint32_t> kept)
      : kept_(std::move(kept)), n_counts_(n_slices * kept_.size()), debts_(n_ranks * n_counts_) {}

  void came(int from, std::span<const std::uint32_t> counts);
  void went(int to, std::span<const std::uint32_t> counts);

  // What the rank may have back of what is to spare; nothing where it is less than `least` in all.
  std::vector<std::uint32_t> due(int to, std::span<const std::uint32_t> spare, std::uint64_t least) const;

 private:
  std::vector<std::uint32_t> kept_;
  std::size_t n_counts_;
  std::vector<std::int64_t> debts_;  // by rank; below 0: the other's
};

// Half of the credits to spare, wherever that leaves both a ray's needs: for a rank that can't go on for want
// of some. `least` by level.
std::vector<std::uint32_t> half_of(std::span<const std::uint32_t> spare,
                                   std::span<const std::uint32_t> least);

}  // namespace kdray::odprt
