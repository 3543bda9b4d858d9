// What    Which queue makes which eye rays. They need not travel where the queue holds what they meet first;
//         which it is changes time, never the picture.
// Shape   Each queue has entries (tiles, or runs of samples) of its own, and some are anyone's. A queue takes
//         its own first, then anyone's, then those of the queue that has most left: rays travel sooner than a
//         queue has nothing to do. All go all over the picture, in steps of the golden section: whatever part
//         of the scene a piece of it shows, the queue that holds that has something to do all the time.
//         (Along the curve half of the queues' time was lost.)
#pragma once

#include <cstddef>
#include <mutex>
#include <span>
#include <vector>

#include "engine/odprt/rank_table.h"
#include "layout/odprt.layout.h"

namespace kdray::odprt {

// Who gets which entries, in the order in which they are to be taken.
struct Assignment {
  std::vector<std::vector<layout::u32>> of_queues;
  std::vector<layout::u32> anyones;
};

class Shares {
 public:
  using Entries = std::vector<layout::u32>;

  explicit Shares(Assignment assigned);

  // Takes at most n entries for a queue. None means that none are left anywhere. Any thread may call it.
  Entries take(std::size_t queue, std::size_t n);

  // Entries that another rank has given, for anyone; and such for another rank, which this one's queues
  // would take last: n at most.
  void add(Entries entries);
  Entries give(std::size_t n);

  // What nobody has taken yet, which nobody gets from then on.
  Entries close();

  std::size_t left() const;
  std::size_t n_queues() const { return own_.size(); }

 private:
  Entries& next_of(std::size_t queue);

  mutable std::mutex mutex_;
  std::vector<Entries> own_;  // the next one last
  Entries anyones_;
};

// Entries of any kind: all are anyone's.
Assignment share_evenly(std::span<const layout::u32> list, std::size_t n_queues);

// Tiles: each belongs to the owner of the part that most of its rays enter first; those whose rays enter none
// are anyone's. `owner`: the queue of each part.
Assignment share_by_part(std::span<const layout::u32> tiles, std::size_t n_queues, const layout::Frame& frame,
                         std::span<const layout::PartCell> directory, std::span<const std::size_t> owner);

// What of them is a rank's: its queues' own, and an equal part of anyone's.
Assignment of_rank(const Assignment& all, const RankTable& table);

}  // namespace kdray::odprt
