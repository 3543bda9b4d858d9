// What    Who renders which tile: shares assigned beforehand, or a bag from which whoever is free takes; and
//         who has taken what, so that the tiles of a queue that fails are rendered by the others.
// Shape   A tile is first in a queue's share or in the bag, then with the queue that took it, then done. What
//         a queue that failed had goes into the bag, from which all take when their own share has come to an
//         end. The bag may be filled bit by bit from elsewhere (ranks): it is open until end().
// Threads Any number; a queue's calls come from one thread at a time.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "kdray/options.h"
#include "layout/frame.layout.h"

namespace kdray::pdprt {

// The size of tiles where none is asked for: small enough that the costliest one is a small part of what a
// compute unit has to do, since the last tile to be begun keeps the frame waiting; large otherwise, since
// rays of a tile are alike and share what they fetch.

// What the tiles of a rendered frame cost.
struct TileCost {
  std::uint64_t tile_pixels = 0;
  double costliest = 0, total = 0;  // seconds of a compute unit

  void add(const TileCost& of_others) {
    costliest = std::max(costliest, of_others.costliest);
    total += of_others.total;
  }
};

constexpr std::uint32_t kLargestTile = 32;

// A square tile's side, `largest` at most. `n_units`: the compute units of all queues. `measured`: of the
// last frame of these sides.
std::uint32_t choose_tile_side(std::uint32_t width, std::uint32_t height, std::uint32_t n_units,
                               const std::optional<TileCost>& measured, std::uint32_t largest = kLargestTile);

// How many tiles a queue may have in work that are to be done `interval` seconds after the list's begin: as
// many as were done up to now in the time that is left, but one for each slice at least.
std::size_t tiles_in_time(double interval, double elapsed, std::size_t n_done, std::size_t n_slices);

// What a queue wants from the bag: a part of what is left there, so that all come to their end together, but
// no more than `most` and no less than `least`; all of that together with the `ahead` that it has.
struct Wanted {
  std::size_t most = 1, least = 1, ahead = 0;
};

class Tiles {
 public:
  // `curve`: entries in the order of the curve. `by_the_piece`: shares are taken as the bag is, so that
  // close() finds something left of them.
  Tiles(std::vector<layout::u32> curve, Division division, std::size_t n_queues, bool by_the_piece = false);

  // An open bag, into which `capacity` entries are put at most.
  static Tiles open(std::size_t n_queues, std::size_t capacity) { return {n_queues, capacity}; }

  // Puts some into an open bag. `elsewhere`: how many more may still come.
  void add(std::span<const layout::u32> entries, std::size_t elsewhere);
  void end();                 // nothing more comes
  std::size_t stock() const;  // what nobody has taken yet
  bool is_over() const;       // everything that came is done
  std::size_t usual() const;  // what the queues take at a time, all together

  // The next entries for the queue: its share, as a whole or up to what is wanted; else from the bag, up to
  // what is wanted. Perhaps
  // none. The span is valid until the queue's next done() or give_back().
  std::span<const layout::u32> take(std::size_t queue, const Wanted& wanted);

  // What the queue took since its last done().
  std::span<const layout::u32> taken(std::size_t queue) const { return taken_[queue]; }

  // What the queue took is in the picture.
  void done(std::size_t queue);

  // The queue has failed: what it took or would have got is for the others. How many tiles it had taken.
  std::size_t give_back(std::size_t queue);

  // Waits until there are tiles for the queue (true), or will never be (false): all are done, or leave() was
  // called.
  bool wait(std::size_t queue);

  // What nobody has taken yet is not for this time: queues end when what they have is in the picture.
  void close();
  // What close() has found.
  const std::vector<layout::u32>& left_over() const { return left_over_; }

  void leave();
  bool left() const;

 private:
  Tiles(std::size_t n_queues, std::size_t capacity);
  bool all_done() const { return ended_ && n_undone_ == 0; }
  bool has_some(std::size_t queue) const { return !shares_[queue].empty() || next_ < bag_.size(); }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::vector<layout::u32>> shares_, taken_;  // per queue
  std::vector<layout::u32> bag_, left_over_;
  bool by_the_piece_;
  std::size_t next_ = 0;  // of the bag
  std::size_t n_undone_, n_queues_;
  std::size_t elsewhere_ = 0;
  std::vector<std::size_t> usual_;  // per queue: how many it took last
  bool ended_ = true, left_ = false;
};

}  // namespace kdray::pdprt
