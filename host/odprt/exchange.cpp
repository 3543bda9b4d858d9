#include "odprt/exchange.h"

#include <algorithm>

namespace kdray::odprt {

Exchange::Exchange(const Plan& plan, std::vector<std::size_t> owner, std::vector<std::vector<bool>> direct,
                   std::vector<std::vector<std::unique_ptr<Outbox>>>& outboxes)
    : owner_(std::move(owner)),
      direct_(std::move(direct)),
      outboxes_(outboxes),
      ledger_(plan.n_slices, plan.capacity, plan.least, outboxes.size()),
      letters_(owner_.size()),
      mail_(owner_.size(), Mail(plan.n_slices, plan.outbox.ray_fields)),
      has_tiles_(outboxes.size(), 1),
      running_(outboxes.size(), 0),
      seen_version_(outboxes.size(), ~std::uint64_t{0}),
      counts_(outboxes.size()) {}

bool Exchange::done() const {
  return ledger_.alive() == 0 &&
         std::none_of(has_tiles_.begin(), has_tiles_.end(), [](char c) { return c; }) &&
         std::none_of(running_.begin(), running_.end(), [](char c) { return c; });
}

Outbox* Exchange::free_outbox(std::size_t queue) const {
  for (const auto& outbox : outboxes_[queue])
    if (outbox->n_readers == 0) return outbox.get();
  return nullptr;
}

// Whether a launch may do something. One that did nothing is not repeated before the ledger has changed.
bool Exchange::may_launch(std::size_t queue, const QueueState& state) const {
  return (state.has_rays || state.has_tiles) &&
         (state.progressed || ledger_.version() != seen_version_[queue]);
}

std::optional<std::uint32_t> Exchange::choose_part(std::size_t queue, const QueueState& state) const {
  if (!letters_[state.part].empty() || mail_[state.part].n > 0 || may_launch(queue, state)) return state.part;
  std::optional<std::uint32_t> best;
  // Where nothing could be done, the deepest rays are what others wait for.
  const auto rank = [&](std::uint32_t part) {
    return state.progressed ? mail_[part].n : std::uint64_t{mail_[part].deepest} << 48 | mail_[part].n;
  };
  for (std::uint32_t part = 0; part < owner_.size(); ++part)
    if (owner_[part] == queue && mail_[part].n > 0 && (!best || rank(part) > rank(*best))) best = part;
  return best;
}

std::optional<Turn> Exchange::next_turn(std::size_t queue, const QueueState& state) {
  std::unique_lock lock(mutex_);
  for (;; changed_.wait(lock)) {
    if (!failures_.empty() || done()) return std::nullopt;
    const std::optional<std::uint32_t> part = choose_part(queue, state);
    if (!part) continue;
    Turn turn;
    turn.part = *part;
    turn.letters.swap(letters_[*part]);
    const bool worth = !turn.letters.empty() || mail_[*part].n > 0 || may_launch(queue, state);
    turn.outbox = worth ? free_outbox(queue) : nullptr;
    if (turn.letters.empty() && !turn.outbox) continue;
    if (turn.outbox) {
      turn.grants.resize(mail_.front().rays.size());
      ledger_.grant(queue, turn.grants);
      seen_version_[queue] = ledger_.version();
      running_[queue] = 1;
    }
    return turn;
  }
}

void Exchange::take_mail(std::uint32_t part, Mail& into) {
  const std::lock_guard lock(mutex_);
  into.take_all(mail_[part]);
}

void Exchange::put_mail(std::uint32_t part, Mail& from) {
  const std::lock_guard lock(mutex_);
  mail_[part].take_all(from);
}

void Exchange::end_turn(std::size_t queue, const Turn& turn, std::span<const layout::Traffic> traffic,
                        const QueueState& state, std::vector<Mail>& sent) {
  const std::lock_guard lock(mutex_);
  for (const Letter& letter : turn.letters) --letter.outbox->n_readers;
  has_tiles_[queue] = state.has_tiles;
  if (turn.outbox) {
    // A queue's own settling changes the ledger, but tells it nothing new.
    const bool news = ledger_.version() != seen_version_[queue];
    ledger_.settle(queue, traffic);
    if (!news) seen_version_[queue] = ledger_.version();
    running_[queue] = 0;
    for (std::uint32_t part = 0; part < owner_.size(); ++part) {
      const bool directly = direct_[queue][part];
      const std::uint64_t n_rays = directly ? turn.outbox->n_rays(part) : sent[part].n_rays();
      const std::uint64_t n_shadow = directly ? turn.outbox->n_shadow_rays(part) : sent[part].n - n_rays;
      if (n_rays + n_shadow == 0) continue;
      counts_.rays[queue][owner_[part]] += n_rays;
      counts_.shadow_rays[queue][owner_[part]] += n_shadow;
      if (directly) {
        ++turn.outbox->n_readers;
        letters_[part].push_back({turn.outbox, queue});
      } else {
        mail_[part].take_all(sent[part]);
      }
    }
  }
  changed_.notify_all();
}

void Exchange::fail(std::size_t queue, std::exception_ptr error) {
  const std::lock_guard lock(mutex_);
  failures_.emplace(queue, std::move(error));
  changed_.notify_all();
}

}  // namespace kdray::odprt
