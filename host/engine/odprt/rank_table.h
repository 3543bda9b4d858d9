// What    The queues of all ranks that render a frame together: each has a number, rank 0's come first.
// Errors  ErrorCode::internal: messages that mean nothing here. transport::Ended.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "cluster/transport/ranks.h"
#include "engine/odprt/ray_credits.h"
#include "layout/frame.layout.h"

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

// What ranks say to each other before and after a list of tiles, or of runs of samples: rank 0 says who
// holds what of the scene, begins each list, and gets the sums that the others' films have of it. A list
// has a number, which goes up over all frames of a run. Sums go home as runs of places that have any; a
// rank has shaded a part of the picture only. All ranks end a list before the next is begun, since rank 0
// waits for their sums. Errors: ErrorCode::internal: messages that mean nothing here. transport::Ended.
inline constexpr transport::Tag kList = transport::kTagsOfLists.first, kSums = kList + 1, kFinish = kList + 2,
                                kReport = kList + 3;

struct ListHead {
  std::uint32_t list = 0, of_runs = 0;
  std::uint64_t first_pixel = 0, n_places = 0, n_entries = 0;  // of the film; of the list
};

struct List {
  ListHead head;
  std::vector<layout::u32> entries, samples;
};

// Who holds which subtree, of rank 0, to all. Returns it.
std::vector<std::uint32_t> share_division(transport::Ranks& ranks, std::vector<std::uint32_t> part_of);

// Of rank 0. Returns the list's number.
std::uint32_t begin_list(transport::Ranks& ranks, ListHead head, std::span<const layout::u32> entries,
                         std::span<const layout::u32> samples);
// Of the others: waits for the next; nothing: the frame is finished.
std::optional<List> next_list(transport::Ranks& ranks);

// Of the others: the film's sums, three to a place, and what of the list nobody here has begun.
void send_sums(transport::Ranks& ranks, std::uint32_t list, std::span<const layout::i64> sums,
               std::span<const layout::u32> left);
// Of rank 0: waits for all sums, adds them up, and puts what is left behind what is there.
void gather_sums(transport::Ranks& ranks, std::uint32_t list, std::span<layout::i64> sums,
                 std::vector<layout::u32>& left);

// Of rank 0: the frame has no more lists. Waits for a report of each of the others.
void finish_lists(transport::Ranks& ranks, const std::function<void(const transport::Message&)>& take_report);

}  // namespace kdray::odprt
