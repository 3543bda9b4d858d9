// What    What ODPRT's queues share: who serves which part, the rays that are on their way, the credits for
//         rays alive (ray_credits.h), and when the frame is done.
// Shape   A queue takes turns: it waits until it has something to do, takes what has come for the part that
//         it serves, launches, and hands over what the launch left. Rays for a part whose queue shares the
//         sender's context lie in the sender's outbox until the receiver has read them; others come by the
//         host's memory (outbox.h). Where a queue has several parts, it goes on with one as long as
//         there is something to do, then to the one for which most rays wait.
// Why     A queue waits for another only when it has no outbox left that isn't being read, or no credits:
//         receivers read before they launch and need nothing for it, so no ring of queues can wait for each
//         other (ray_credits.h has the rest).
// Ranks   With others (rank_exchange.h) the host's rays for their parts go to them, and only all together
//         know when the frame is done.
// Threads One for each queue, and one for the exchange between ranks.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "engine/odprt/outbox.h"
#include "engine/odprt/plan.h"
#include "engine/odprt/rank_table.h"
#include "engine/odprt/ray_credits.h"
#include "engine/odprt/shares.h"

namespace kdray::odprt {

// Rays that have come for a part, still in an outbox of a queue of the same context.
struct DeviceMessage {
  Outbox* outbox = nullptr;
  std::size_t from = 0;
};

// What a queue does next.
struct Turn {
  std::uint32_t part = 0;
  std::vector<DeviceMessage> messages;
  Outbox* outbox = nullptr;  // nullptr: no launch
  std::vector<layout::Credits> credits;
};

// What a queue knows of itself after a turn.
struct QueueState {
  std::uint32_t part = 0;  // that it serves
  bool has_tiles = true;   // eye rays still to make, beside what it may take of others'
  bool has_rays = false;   // in its pools, or taken from the host's memory
  bool progressed = true;  // the last launch did something
};

// Rays of each queue to each, of all ranks.
struct ExchangeCounts {
  std::vector<std::vector<std::uint64_t>> rays, shadow_rays;  // [from][to]
  explicit ExchangeCounts(std::size_t n)
      : rays(n, std::vector<std::uint64_t>(n)), shadow_rays(n, std::vector<std::uint64_t>(n)) {}
  // What some of them have sent: the others' rows are empty. All rows of 2048 queues take 64 MiB.
  ExchangeCounts(std::size_t n, std::size_t first, std::size_t n_own) : rays(n), shadow_rays(n) {
    for (std::size_t from = first; from < first + n_own; ++from) {
      rays[from].resize(n);
      shadow_rays[from].resize(n);
    }
  }
};

class Exchange {
 public:
  // `owner` has the queue of each part, among those of all ranks; `direct[q][p]`: queue q's outbox can be
  // read by the queue of part p. Else queues are this rank's.
  Exchange(const BufferPlan& plan, const RankTable& table, std::vector<std::size_t> owner,
           std::vector<std::vector<bool>> direct, std::vector<std::vector<std::unique_ptr<Outbox>>>& outboxes,
           const Shares& shares);

  // Blocks until there is something to do. Returns nothing when the frame is done or a queue has failed.
  std::optional<Turn> next_turn(std::size_t queue, const QueueState& state);
  // The same for who must not block: nothing also where there is nothing to do now.
  std::optional<Turn> try_turn(std::size_t queue, const QueueState& state);

  // Takes over what came by the host's memory for the part of the turn.
  void take_host_rays(std::uint32_t part, HostRayQueue& into);
  // Hands back what a queue has had of a part's rays.
  void put_host_rays(std::uint32_t part, HostRayQueue& from);

  // Called when the commands of the turn have ended. `sent` has the rays for each part that is not
  // reached directly.
  void end_turn(std::size_t queue, const Turn& turn, std::span<const layout::Traffic> traffic,
                const QueueState& state, std::vector<HostRayQueue>& sent);

  // A queue leaves, and so do all others at their next turn.
  void fail(std::size_t queue, std::exception_ptr error);
  const std::map<std::size_t, std::exception_ptr>& failures() const { return failures_; }  // by queue

  // For RankExchange, of rays by part, and of counts by slice and level (ray_credits.h).
  bool is_busy() const;              // some queue is at work, or will be at once
  bool is_idle() const;              // there is nothing at all to do
  bool is_short_of_credits() const;  // there is something to do, and no queue could do any of it
  std::uint64_t n_host_rays(std::uint32_t first_part, std::size_t n_parts) const;
  void depart(std::span<const std::uint32_t> counts);
  void deliver(std::uint32_t first_part, std::span<HostRayQueue> host_rays,
               std::span<const std::uint32_t> counts);
  void add_credits(std::span<const std::uint32_t> counts);
  // Takes away what `choose` says of the credits to spare, and returns it. At once: a queue may want it too.
  using Counts = std::vector<std::uint32_t>;
  Counts take_credits(const std::function<Counts(std::span<const std::uint32_t> spare)>& choose);
  void tiles_have_come();
  void finish();

  bool direct(std::size_t queue, std::uint32_t part) const { return direct_[queue][part]; }
  const ExchangeCounts& counts() const { return counts_; }

 private:
  std::optional<std::uint32_t> choose_part(std::size_t queue, const QueueState& state) const;
  std::optional<Turn> begin_turn(std::size_t queue, const QueueState& state);
  Outbox* free_outbox(std::size_t queue) const;
  bool nothing_is_left() const;
  void wake();
  bool may_launch(std::size_t queue, const QueueState& state) const;
  bool done() const;

  const RankTable table_;
  const std::vector<std::size_t> owner_;
  const std::vector<std::vector<bool>> direct_;
  std::vector<std::vector<std::unique_ptr<Outbox>>>& outboxes_;
  const Shares& shares_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  RayCredits credits_;
  std::vector<std::vector<DeviceMessage>> messages_;  // by part
  std::vector<HostRayQueue> host_rays_;               // by part
  std::vector<char> has_tiles_, running_;             // by queue
  std::vector<char> waiting_;                // by queue: in next_turn(), with nothing that it could do
  std::vector<char> stuck_;                  // by queue: its last launch did nothing
  bool finished_ = false;                    // with other ranks: there and here
  std::vector<std::uint64_t> seen_version_;  // of the credits, by queue, when it last launched
  ExchangeCounts counts_;
  std::map<std::size_t, std::exception_ptr> failures_;
};

}  // namespace kdray::odprt
