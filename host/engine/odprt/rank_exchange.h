// What    What goes between ranks while they render a list of tiles together: rays to the ranks whose parts
//         they come to next, credits back to where they came from, tiles from ranks that have some
//         left to those that have none, and the question whether all are done.
// Shape   step() does all of it, and waits for nothing; the thread that waits for the queues calls it. Rays
//         go in batches: of a size that is worth a message, or what there is when no queue here has anything
//         to do, or when it has waited for some milliseconds.
// Why     Nothing waits in a circle. A rank takes whatever comes, at once: the sum of all credits is what
//         every pool can hold (ray_credits.h), so rays in the host's memory are no more than that. A queue
//         that can't launch for want of credits asks all ranks for some, and each gives half of what it has
//         to spare. The rays that may go on first, the deepest, make rays of a level of which there are none:
//         all of that level's credits are to spare, twice what every rank needs for a ray (plan.h), so
//         somebody has that.
// Errors  ErrorCode::internal: messages that mean nothing here. transport::Ended.
// Threads One.
#pragma once

#include <functional>
#include <vector>

#include "engine/odprt/exchange.h"
#include "engine/odprt/rank_table.h"
#include "engine/odprt/ray_batch.h"
#include "engine/odprt/ray_credits.h"
#include "engine/odprt/shares.h"
#include "engine/odprt/termination_detector.h"

namespace kdray::odprt {

class RankExchange {
 public:
  // `is_entry`: whether the list may have such an entry.
  RankExchange(const RankTable& table, std::uint32_t list, const RaysKnown& known, const BufferPlan& plan,
               Exchange& exchange, Shares& shares, std::function<bool(layout::u32)> is_entry);

  void step();
  bool is_over() const { return is_over_; }

  // Of rank 0: nothing more of the list is begun, anywhere.
  void close();
  // What nobody on this rank has begun when the list was closed.
  const Shares::Entries& left() const { return left_; }

 private:
  int rank() const { return table_.ranks->rank(); }
  int n_ranks() const { return table_.ranks->size(); }
  bool has_nothing_to_do() const { return exchange_.is_idle() && !awaits_tiles_; }

  void take(const transport::Message& message);
  void take_rays(const transport::Message& message);
  void take_tiles(const transport::Message& message);
  void take_credits(const transport::Message& message);
  void give_tiles(int to);
  using Choose = std::function<Exchange::Counts(std::span<const std::uint32_t> spare)>;
  void give_credits(int to, bool is_answer, const Choose& choose);

  void send_rays();
  void ask_for_tiles();
  void ask_for_credits();
  void return_credits();
  void say_whether_idle();
  void close_here();
  void end_here();

  RankTable table_;
  std::uint32_t list_;
  RaysKnown known_;
  std::vector<std::uint32_t> least_;  // by level
  std::uint64_t least_credits_;       // that is worth a message
  Exchange& exchange_;
  Shares& shares_;
  std::function<bool(layout::u32)> is_entry_;

  std::vector<std::vector<HostRayQueue>> out_;  // by rank and part of it
  std::vector<HostRayQueue> in_;
  std::vector<double> waiting_since_;  // by rank, what is to go there; < 0: nothing
  CreditDebts debts_;
  WorkMessages work_;
  TerminationDetector termination_;  // rank 0's
  std::uint32_t asked_wave_ = 0;     // of the others: that they haven't answered yet
  int next_victim_ = 1;              // how many ranks on
  bool awaits_tiles_ = false, is_closed_ = false, is_over_ = false;
  int n_credits_awaited_ = 0;
  double credits_asked_ = -1, credits_returned_ = 0;
  Shares::Entries left_;
};

}  // namespace kdray::odprt
