// What    What ODPRT's queues share: who serves which part, the rays that are on their way, the ledger of
//         rays alive, and when the frame is done.
// Shape   A queue takes turns: it waits until it has something to do, takes what has come for the part that
//         it serves, launches, and hands over what the launch left. Rays for a part whose queue shares the
//         sender's context lie in the sender's outbox until the receiver has read them; others come by the
//         host's memory (mail). Where a queue has several parts, it goes on with one as long as there is
//         something to do, then to the one for which most rays wait.
// Why     A queue waits for another only when it has no outbox left that isn't being read, or no grant:
//         receivers read before they launch and need nothing for it, so no ring of queues can wait for each
//         other (ledger.h has the rest).
// Threads One for each queue.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "odprt/ledger.h"
#include "odprt/mail.h"
#include "odprt/outbox.h"
#include "odprt/plan.h"

namespace kdray::odprt {

// Rays that have come for a part, still in an outbox of a queue of the same context.
struct Letter {
  Outbox* outbox = nullptr;
  std::size_t from = 0;
};

// What a queue does next.
struct Turn {
  std::uint32_t part = 0;
  std::vector<Letter> letters;
  Outbox* outbox = nullptr;  // nullptr: no launch
  std::vector<layout::Grant> grants;
};

// What a queue knows of itself after a turn.
struct QueueState {
  std::uint32_t part = 0;  // that it serves
  bool has_tiles = true;   // eye rays still to make, its own or what it may take of others'
  bool has_rays = false;   // in its pools, or in mail that it has taken
  bool progressed = true;  // the last launch did something
};

// Rays of each queue to each.
struct ExchangeCounts {
  std::vector<std::vector<std::uint64_t>> rays, shadow_rays;  // [from][to]
  explicit ExchangeCounts(std::size_t n)
      : rays(n, std::vector<std::uint64_t>(n)), shadow_rays(n, std::vector<std::uint64_t>(n)) {}
};

class Exchange {
 public:
  // `owner` has the queue of each part; `direct[q][p]`: queue q's outbox can be read by the queue of part p.
  Exchange(const Plan& plan, std::vector<std::size_t> owner, std::vector<std::vector<bool>> direct,
           std::vector<std::vector<std::unique_ptr<Outbox>>>& outboxes);

  // Blocks until there is something to do. Returns nothing when the frame is done or a queue has failed.
  std::optional<Turn> next_turn(std::size_t queue, const QueueState& state);

  // Takes over what came by mail for the part of the turn.
  void take_mail(std::uint32_t part, Mail& into);
  // Hands back what a queue has had of a part's mail, or of its rays.
  void put_mail(std::uint32_t part, Mail& from);

  // Called when the commands of the turn have ended. `sent` has the mail for each part that is not reached
  // directly.
  void end_turn(std::size_t queue, const Turn& turn, std::span<const layout::Traffic> traffic,
                const QueueState& state, std::vector<Mail>& sent);

  // A queue leaves, and so do all others at their next turn.
  void fail(std::size_t queue, std::exception_ptr error);
  const std::map<std::size_t, std::exception_ptr>& failures() const { return failures_; }  // by queue

  bool direct(std::size_t queue, std::uint32_t part) const { return direct_[queue][part]; }
  const ExchangeCounts& counts() const { return counts_; }

 private:
  std::optional<std::uint32_t> choose_part(std::size_t queue, const QueueState& state) const;
  Outbox* free_outbox(std::size_t queue) const;
  bool may_launch(std::size_t queue, const QueueState& state) const;
  bool done() const;

  const std::vector<std::size_t> owner_;
  const std::vector<std::vector<bool>> direct_;
  std::vector<std::vector<std::unique_ptr<Outbox>>>& outboxes_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Ledger ledger_;
  std::vector<std::vector<Letter>> letters_;  // by part
  std::vector<Mail> mail_;                    // by part
  std::vector<char> has_tiles_, running_;     // by queue
  std::vector<std::uint64_t> seen_version_;   // of the ledger, by queue, when it last launched
  ExchangeCounts counts_;
  std::map<std::size_t, std::exception_ptr> failures_;
};

}  // namespace kdray::odprt
