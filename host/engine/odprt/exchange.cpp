#include "engine/odprt/exchange.h"

#include <algorithm>

namespace kdray::odprt {

Exchange::Exchange(const BufferPlan& plan, const RankTable& table, std::vector<std::size_t> owner,
                   std::vector<std::vector<bool>> direct,
                   std::vector<std::vector<std::unique_ptr<Outbox>>>& outboxes, const Shares& shares)
    : table_(table),
      owner_(std::move(owner)),
      direct_(std::move(direct)),
      outboxes_(outboxes),
      shares_(shares),
      credits_(plan.n_slices, plan.capacity, plan.least, outboxes.size(), table.place()),
      messages_(owner_.size()),
      host_rays_(owner_.size(), HostRayQueue(plan.n_slices, plan.outbox.ray_fields)),
      has_tiles_(outboxes.size(), 1),
      running_(outboxes.size(), 0),
      waiting_(outboxes.size(), 0),
      stuck_(outboxes.size(), 0),
      seen_version_(outboxes.size(), ~std::uint64_t{0}),
      counts_(table.n_queues(), table.own_first(), table.n_own()) {}

bool Exchange::done() const {
  return table_.ranks ? finished_ : nothing_is_left();
}

bool Exchange::nothing_is_left() const {
  return credits_.alive() == 0 &&
         std::none_of(has_tiles_.begin(), has_tiles_.end(), [](char c) { return c; }) &&
         std::none_of(running_.begin(), running_.end(), [](char c) { return c; });
}

Outbox* Exchange::free_outbox(std::size_t queue) const {
  for (const auto& outbox : outboxes_[queue])
    if (outbox->n_readers == 0) return outbox.get();
  return nullptr;
}

// Whether a launch may do something. One that did nothing is not repeated before the credits have changed.
bool Exchange::may_launch(std::size_t queue, const QueueState& state) const {
  return (state.has_rays || has_tiles_[queue]) &&
         (state.progressed || credits_.version() != seen_version_[queue]);
}

std::optional<std::uint32_t> Exchange::choose_part(std::size_t queue, const QueueState& state) const {
  if (!messages_[state.part].empty() || host_rays_[state.part].n > 0 || may_launch(queue, state))
    return state.part;
  std::optional<std::uint32_t> best;
  // Where nothing could be done, the deepest rays are what others wait for.
  const auto rank = [&](std::uint32_t part) {
    return state.progressed ? host_rays_[part].n
                            : std::uint64_t{host_rays_[part].deepest} << 48 | host_rays_[part].n;
  };
  const std::size_t own = table_.own_first() + queue;
  for (std::uint32_t part = 0; part < owner_.size(); ++part)
    if (owner_[part] == own && host_rays_[part].n > 0 && (!best || rank(part) > rank(*best))) best = part;
  return best;
}

// The caller locks.
std::optional<Turn> Exchange::begin_turn(std::size_t queue, const QueueState& state) {
  const std::optional<std::uint32_t> part = choose_part(queue, state);
  if (!part) return std::nullopt;
  Turn turn;
  turn.part = *part;
  turn.messages.swap(messages_[*part]);
  const bool worth = !turn.messages.empty() || host_rays_[*part].n > 0 || may_launch(queue, state);
  turn.outbox = worth ? free_outbox(queue) : nullptr;
  if (turn.messages.empty() && !turn.outbox) return std::nullopt;
  if (turn.outbox) {
    turn.credits.resize(host_rays_.front().rays.size());
    credits_.grant(queue, turn.credits);
    seen_version_[queue] = credits_.version();
    running_[queue] = 1;
  }
  return turn;
}

std::optional<Turn> Exchange::next_turn(std::size_t queue, const QueueState& state) {
  std::unique_lock lock(mutex_);
  for (;; waiting_[queue] = 1, changed_.wait(lock)) {
    waiting_[queue] = 0;
    if (!failures_.empty() || done()) return std::nullopt;
    if (std::optional<Turn> turn = begin_turn(queue, state)) return turn;
  }
}

std::optional<Turn> Exchange::try_turn(std::size_t queue, const QueueState& state) {
  const std::lock_guard lock(mutex_);
  waiting_[queue] = 0;
  if (!failures_.empty() || done()) return std::nullopt;
  std::optional<Turn> turn = begin_turn(queue, state);
  waiting_[queue] = !turn;
  return turn;
}

void Exchange::take_host_rays(std::uint32_t part, HostRayQueue& into) {
  const std::lock_guard lock(mutex_);
  into.take_all(host_rays_[part]);
}

void Exchange::put_host_rays(std::uint32_t part, HostRayQueue& from) {
  const std::lock_guard lock(mutex_);
  host_rays_[part].take_all(from);
}

void Exchange::end_turn(std::size_t queue, const Turn& turn, std::span<const layout::Traffic> traffic,
                        const QueueState& state, std::vector<HostRayQueue>& sent) {
  const std::lock_guard lock(mutex_);
  for (const DeviceMessage& message : turn.messages) --message.outbox->n_readers;
  has_tiles_[queue] = state.has_tiles || shares_.left() > 0;
  if (turn.outbox) {
    // A queue's own settling changes the credits, but tells it nothing new.
    const bool news = credits_.version() != seen_version_[queue];
    credits_.settle(queue, traffic);
    if (!news) seen_version_[queue] = credits_.version();
    running_[queue] = 0;
    stuck_[queue] = !state.progressed;
    for (std::uint32_t part = 0; part < owner_.size(); ++part) {
      const bool directly = direct_[queue][part];
      const std::uint64_t n_rays = directly ? turn.outbox->n_rays(part) : sent[part].n_rays();
      const std::uint64_t n_shadow = directly ? turn.outbox->n_shadow_rays(part) : sent[part].n - n_rays;
      if (n_rays + n_shadow == 0) continue;
      const std::size_t from = table_.own_first() + queue;
      counts_.rays[from][owner_[part]] += n_rays;
      counts_.shadow_rays[from][owner_[part]] += n_shadow;
      if (directly) {
        ++turn.outbox->n_readers;
        messages_[part].push_back({turn.outbox, queue});
      } else {
        host_rays_[part].take_all(sent[part]);
      }
    }
  }
  wake();
}

bool Exchange::is_busy() const {
  const std::lock_guard lock(mutex_);
  return std::ranges::any_of(waiting_, [](char waits) { return !waits; });
}

bool Exchange::is_idle() const {
  const std::lock_guard lock(mutex_);
  return nothing_is_left();
}

bool Exchange::is_short_of_credits() const {
  const std::lock_guard lock(mutex_);
  if (nothing_is_left()) return false;
  bool any = false, all = true;
  for (std::size_t q = 0; q < stuck_.size(); ++q) {
    any = any || stuck_[q] != 0;
    all = all && (stuck_[q] != 0 || waiting_[q] != 0);  // one that waits may have no rays
  }
  return any && all;
}

std::uint64_t Exchange::n_host_rays(std::uint32_t first_part, std::size_t n_parts) const {
  const std::lock_guard lock(mutex_);
  std::uint64_t n = 0;
  for (std::size_t p = 0; p < n_parts; ++p) n += host_rays_[first_part + p].n;
  return n;
}

void Exchange::depart(std::span<const std::uint32_t> counts) {
  const std::lock_guard lock(mutex_);
  credits_.depart(counts);
}

void Exchange::deliver(std::uint32_t first_part, std::span<HostRayQueue> host_rays,
                       std::span<const std::uint32_t> counts) {
  const std::lock_guard lock(mutex_);
  credits_.arrive(counts);
  for (std::size_t p = 0; p < host_rays.size(); ++p) host_rays_[first_part + p].take_all(host_rays[p]);
  wake();
}

void Exchange::add_credits(std::span<const std::uint32_t> counts) {
  const std::lock_guard lock(mutex_);
  credits_.add_credits(counts);
  wake();
}

Exchange::Counts Exchange::take_credits(
    const std::function<Counts(std::span<const std::uint32_t> spare)>& choose) {
  const std::lock_guard lock(mutex_);
  Counts taken = choose(credits_.spare());
  credits_.take_credits(taken);
  return taken;
}

void Exchange::tiles_have_come() {
  const std::lock_guard lock(mutex_);
  std::ranges::fill(has_tiles_, 1);
  std::ranges::fill(seen_version_, ~std::uint64_t{0});
  wake();
}

void Exchange::finish() {
  const std::lock_guard lock(mutex_);
  finished_ = true;
  wake();
}

// Whoever waits looks anew, and counts as busy until it has.
void Exchange::wake() {
  std::ranges::fill(waiting_, 0);
  changed_.notify_all();
}

void Exchange::fail(std::size_t queue, std::exception_ptr error) {
  const std::lock_guard lock(mutex_);
  failures_.emplace(queue, std::move(error));
  wake();
}

}  // namespace kdray::odprt
