#include "engine/odprt/rank_exchange.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace kdray::odprt {

namespace {

using transport::head_of, transport::refuse, transport::to_bytes, transport::words_behind;

constexpr transport::Tag kRays = transport::kTagsOfRays.first, kCredits = kRays + 1, kWantCredits = kRays + 2,
                         kTiles = kRays + 3, kWantTiles = kRays + 4, kWave = kRays + 5, kIdle = kRays + 6,
                         kClose = kRays + 7, kOver = kRays + 8;

constexpr std::size_t kBatchBytes = std::size_t{64} << 10, kMostBytes = std::size_t{1} << 20;
constexpr double kPatience = 2e-3;         // seconds that rays wait for others to go with
constexpr double kCreditsEvery = 2e-3;     // seconds between two looks at what is owed, or wanted
constexpr std::uint64_t kCreditsPart = 4;  // of a level's share: what is worth a message

struct Head {
  std::uint32_t list = 0, wave = 0;
};

struct IdleHead {
  std::uint32_t list = 0, wave = 0;
  WorkMessages work;
};

struct CreditsHead {
  std::uint32_t list = 0, is_answer = 0;
};

// What this rank's queues need at least.
std::vector<std::uint32_t> kept(const BufferPlan& plan, std::size_t n_queues) {
  std::vector<std::uint32_t> kept = plan.least;
  for (std::uint32_t& n : kept) n *= static_cast<std::uint32_t>(n_queues);
  return kept;
}

}  // namespace

RankExchange::RankExchange(const RankTable& table, std::uint32_t list, const RaysKnown& known,
                           const BufferPlan& plan, Exchange& exchange, Shares& shares,
                           std::function<bool(layout::u32)> is_entry)
    : table_(table),
      list_(list),
      known_(known),
      least_(plan.least),
      least_credits_(std::max<std::uint64_t>(
          1, *std::ranges::max_element(plan.capacity) * std::uint64_t{known.n_slices} /
                 (static_cast<std::uint64_t>(table.ranks->size()) * kCreditsPart))),
      exchange_(exchange),
      shares_(shares),
      is_entry_(std::move(is_entry)),
      in_(known.n_parts, HostRayQueue(known.n_slices, known.ray_fields)),
      waiting_since_(static_cast<std::size_t>(n_ranks()), -1),
      debts_(static_cast<std::size_t>(n_ranks()), known.n_slices, kept(plan, table.n_own())),
      termination_(static_cast<std::size_t>(n_ranks())) {
  for (std::size_t r = 0; r < waiting_since_.size(); ++r)
    out_.emplace_back(table_.first[r + 1] - table_.first[r], HostRayQueue(known.n_slices, known.ray_fields));
}

void RankExchange::step() {
  while (!is_over_) {
    const auto message = table_.ranks->next(transport::kTagsOfRays);
    if (!message) break;
    take(*message);
  }
  if (is_over_) return;
  send_rays();
  ask_for_tiles();
  ask_for_credits();
  return_credits();
  say_whether_idle();
}

void RankExchange::take(const transport::Message& message) {
  const auto list = head_of<std::uint32_t>(message);
  const bool brings_work = message.tag == kRays || message.tag == kTiles;
  // Others may come after their list's end, which they have no part in.
  if (list != list_ && (brings_work || static_cast<std::int32_t>(list - list_) > 0)) refuse(message);
  if (list != list_) return;
  const bool of_rank_0 = message.from == 0 && rank() != 0;
  switch (message.tag) {
    case kRays:
      return take_rays(message);
    case kTiles:
      return take_tiles(message);
    case kWantTiles:
      return give_tiles(message.from);
    case kCredits:
      return take_credits(message);
    case kWantCredits:
      return give_credits(message.from, true, [&](auto spare) { return half_of(spare, least_); });
    case kWave:
      if (!of_rank_0) refuse(message);
      asked_wave_ = head_of<Head>(message).wave;
      return;
    case kIdle: {
      const auto head = head_of<IdleHead>(message);
      if (rank() != 0 || !termination_.answer(static_cast<std::size_t>(message.from), head.wave, head.work))
        refuse(message);
      return;
    }
    case kClose:
      if (!of_rank_0) refuse(message);
      return close_here();
    case kOver:
      if (!of_rank_0) refuse(message);
      return end_here();
    default:
      refuse(message);
  }
}

void RankExchange::take_rays(const transport::Message& message) {
  std::vector<std::uint32_t> counts(known_.n_counts());
  unpack_rays(message, known_, in_, counts);
  debts_.came(message.from, counts);
  ++work_.received;
  exchange_.deliver(known_.first_part, in_, counts);
}

// What no queue here has anything to do with goes at once: elsewhere one may.
void RankExchange::send_rays() {
  const double now = table_.ranks->now();
  const bool at_once = !exchange_.is_busy();
  for (int to = 0; to < n_ranks(); ++to) {
    const auto r = static_cast<std::size_t>(to);
    if (to == rank() || out_[r].empty()) continue;
    const auto first = static_cast<std::uint32_t>(table_.first[r]);
    const std::uint64_t n = exchange_.n_host_rays(first, out_[r].size());
    if (n == 0) continue;
    if (waiting_since_[r] < 0) waiting_since_[r] = now;
    if (!at_once && n * known_.ray_fields * sizeof(float) < kBatchBytes &&
        now - waiting_since_[r] < kPatience)
      continue;
    for (std::size_t p = 0; p < out_[r].size(); ++p)
      exchange_.take_host_rays(first + static_cast<std::uint32_t>(p), out_[r][p]);
    const auto is_left = [](const HostRayQueue& host_rays) { return host_rays.n > 0; };
    while (std::ranges::any_of(out_[r], is_left)) {
      std::vector<std::uint32_t> counts(known_.n_counts());
      transport::Bytes bytes = pack_rays(list_, first, out_[r], kMostBytes, counts);
      debts_.went(to, counts);
      ++work_.sent;
      table_.ranks->send(to, kRays, std::move(bytes));
      exchange_.depart(counts);
    }
    waiting_since_[r] = -1;
  }
}

void RankExchange::ask_for_tiles() {
  if (awaits_tiles_ || is_closed_ || next_victim_ >= n_ranks() || shares_.left() > 0) return;
  awaits_tiles_ = true;
  table_.ranks->send((rank() + next_victim_) % n_ranks(), kWantTiles, to_bytes(Head{list_, 0}));
}

void RankExchange::give_tiles(int to) {
  const Shares::Entries entries = shares_.give(shares_.left() / 2);
  ++work_.sent;
  table_.ranks->send(to, kTiles, to_bytes(Head{list_, 0}, entries));
}

void RankExchange::take_tiles(const transport::Message& message) {
  Shares::Entries entries = words_behind<Head>(message);
  if (!awaits_tiles_ || !std::ranges::all_of(entries, is_entry_)) refuse(message);
  awaits_tiles_ = false;
  ++work_.received;
  if (entries.empty()) ++next_victim_;
  if (is_closed_) {
    left_.insert(left_.end(), entries.begin(), entries.end());
  } else if (!entries.empty()) {
    shares_.add(std::move(entries));
    exchange_.tiles_have_come();
  }
}

void RankExchange::ask_for_credits() {
  const double now = table_.ranks->now();
  if (n_credits_awaited_ > 0 || now - credits_asked_ < kCreditsEvery || !exchange_.is_short_of_credits())
    return;
  credits_asked_ = now;
  n_credits_awaited_ = n_ranks() - 1;
  table_.ranks->send_to_others(kWantCredits, to_bytes(Head{list_, 0}));
}

// An answer is given in any case.
void RankExchange::give_credits(int to, bool is_answer, const Choose& choose) {
  const Exchange::Counts counts = exchange_.take_credits(choose);
  if (counts.empty() && !is_answer) return;
  debts_.went(to, counts);
  table_.ranks->send(to, kCredits, to_bytes(CreditsHead{list_, is_answer ? 1u : 0u}, counts));
}

void RankExchange::take_credits(const transport::Message& message) {
  const std::vector<std::uint32_t> counts = words_behind<CreditsHead>(message);
  const bool is_answer = head_of<CreditsHead>(message).is_answer != 0;
  if (counts.size() != known_.n_counts() || (is_answer && n_credits_awaited_ == 0)) refuse(message);
  if (is_answer) --n_credits_awaited_;
  debts_.came(message.from, counts);
  exchange_.add_credits(counts);
}

void RankExchange::return_credits() {
  const double now = table_.ranks->now();
  if (now - credits_returned_ < kCreditsEvery) return;
  credits_returned_ = now;
  for (int to = 0; to < n_ranks(); ++to)
    if (to != rank())
      give_credits(to, false, [&](auto spare) { return debts_.due(to, spare, least_credits_); });
}

void RankExchange::say_whether_idle() {
  if (!has_nothing_to_do()) return;
  if (rank() != 0) {
    if (asked_wave_ == 0) return;
    table_.ranks->send(0, kIdle, to_bytes(IdleHead{list_, std::exchange(asked_wave_, 0), work_}));
    return;
  }
  if (termination_.is_asking()) return;
  if (termination_.is_over()) {
    table_.ranks->send_to_others(kOver, to_bytes(Head{list_, 0}));
    return end_here();
  }
  termination_.begin_wave();
  table_.ranks->send_to_others(kWave, to_bytes(Head{list_, termination_.wave()}));
  termination_.answer(0, termination_.wave(), work_);
}

void RankExchange::close() {
  table_.ranks->send_to_others(kClose, to_bytes(Head{list_, 0}));
  close_here();
}

void RankExchange::close_here() {
  is_closed_ = true;
  const Shares::Entries left = shares_.close();
  left_.insert(left_.end(), left.begin(), left.end());
}

void RankExchange::end_here() {
  is_over_ = true;
  exchange_.finish();
}

}  // namespace kdray::odprt
