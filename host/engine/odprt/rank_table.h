// What    The queues of all ranks that render a frame together: each has a number, rank 0's come first.
// Errors  ErrorCode::internal: messages that mean nothing here. transport::Ended.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "cluster/transport/ranks.h"
#include "engine/odprt/ray_credits.h"

namespace kdray::odprt {

struct RankTable {
  transport::Ranks* ranks = nullptr;     // null: this process works alone
  std::vector<std::size_t> first = {0};  // queue of each rank, and behind them how many there are
  std::size_t n_queues() const { return first.back(); }

  bool leads() const { return ranks == nullptr || ranks->leads(); }
  RankOf place() const {
    if (ranks == nullptr) return {};
    return {static_cast<std::uint32_t>(ranks->rank()), static_cast<std::uint32_t>(ranks->size())};
  }
  std::size_t own_first() const { return first[place().rank]; }
  std::size_t n_own() const { return first[place().rank + 1] - own_first(); }
  bool is_own(std::size_t queue) const { return queue - own_first() < n_own(); }
  int rank_of(std::size_t queue) const {
    return static_cast<int>(std::upper_bound(first.begin(), first.end(), queue) - first.begin()) - 1;
  }
};

// Of one process.
inline RankTable alone(std::size_t n_queues) {
  return {nullptr, {0, n_queues}};
}

struct Joined {
  RankTable table;
  std::uint32_t n_slices = 0;  // of each queue: the most that any rank wants
};

// Tells rank 0 how many queues this rank has, and hears how many there are in all.
Joined join(transport::Ranks& ranks, std::size_t n_queues, std::uint32_t n_slices);

}  // namespace kdray::odprt
