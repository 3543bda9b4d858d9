// What    How many rays are alive, for each slice and depth, over all queues; and how many each queue may
//         make.
// Shape   Level 0 is shadow rays on their way, level d rays of depth d. A level has a capacity for each
//         slice; before a launch a queue is granted a share of what is left of it, and gives back what it
//         didn't use. In the launch what it ends adds to the
//         grant: what it makes less what it ends never exceeds what it was granted.
// Why     (1) A level's rays never exceed its capacity, so every queue's pool can hold all of them, and
//         receiving can't fail.
//         (2) Some queue can always go on: rays of the greatest depth that is alive make rays of a depth of
//             which none is, so all of
//         its capacity can be granted; what other queues hold of it comes back when their launches end.
//         Shadow rays make nothing. So the deepest rays go, then those above.
//         (3) When every count is 0 and no queue has tiles left, the frame is done: nothing is on its way,
//             since a ray is counted
//         from where it is made to where it ends.
// Ranks   Each has such a ledger, and begins with an equal share of the capacity as its room. A ray that goes
//         to another rank takes its place along: room there is that much more, and here less. So the sum of
//         all room is the capacity, whoever has how much of it, and (1) holds without anybody knowing all
//         counts; room.h has how room comes back to where it is wanted, which (2) asks for.
// Threads The caller locks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "layout/odprt.layout.h"

namespace kdray::odprt {

// Which of how many ranks this is.
struct RankOf {
  std::uint32_t rank = 0, ranks = 1;
};

class Ledger {
 public:
  // `least` is what a grant at a level has at least, as far as that is left: what one ray may make.
  // `n_queues` of this rank.
  Ledger(std::size_t n_slices, const std::vector<std::uint32_t>& capacity, std::vector<std::uint32_t> least,
         std::size_t n_queues, RankOf rank = {});

  // Grants what the slices may make in the queue's next launch.
  void grant(std::size_t queue, std::span<layout::Grant> grants);

  // Takes over what the launch made and ended, and takes its grants back.
  void settle(std::size_t queue, std::span<const layout::Traffic> traffic);

  std::uint64_t alive() const { return alive_total_; }

  // Rays that have gone to another rank, or come from one, with their places.
  void depart(std::span<const std::uint32_t> counts);
  void arrive(std::span<const std::uint32_t> counts);

  // Room that no ray has and no launch may want. Counts, like the others, by slice and level.
  std::vector<std::uint32_t> spare() const;
  void add_room(std::span<const std::uint32_t> counts);
  void take_room(std::span<const std::uint32_t> counts);  // of what is to spare

  // Counts how often something was granted or given back. A queue that had nothing to do need not look again
  // before it changes.
  std::uint64_t version() const { return version_; }

 private:
  std::size_t n_levels() const { return least_.size(); }
  std::size_t at(std::size_t slice, std::size_t level) const { return slice * n_levels() + level; }

  std::vector<std::uint32_t> least_;                   // by level
  std::vector<std::uint32_t> room_, alive_, granted_;  // by slice and level
  std::vector<std::vector<std::uint32_t>> held_;       // by queue: its part of granted_
  std::size_t n_holding_ = 0;
  std::uint64_t alive_total_ = 0, version_ = 0;
};

}  // namespace kdray::odprt
