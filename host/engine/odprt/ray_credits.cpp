#include "engine/odprt/ray_credits.h"

#include <algorithm>

namespace kdray::odprt {

RayCredits::RayCredits(std::size_t n_slices, const std::vector<std::uint32_t>& capacity,
                       std::vector<std::uint32_t> least, std::size_t n_queues, RankOf rank)
    : least_(std::move(least)),
      alive_(n_slices * capacity.size()),
      granted_(alive_.size()),
      held_(n_queues, std::vector<std::uint32_t>(alive_.size())) {
  for (std::size_t slice = 0; slice < n_slices; ++slice)
    for (const std::uint32_t n : capacity)
      credits_.push_back(n / rank.ranks + (rank.rank < n % rank.ranks ? 1 : 0));
}

void RayCredits::grant(std::size_t queue, std::span<layout::Credits> credits) {
  // Queues that hold nothing now may want their share.
  const auto n_waiting = static_cast<std::uint32_t>(held_.size() - n_holding_);
  for (std::size_t slice = 0; slice < credits.size(); ++slice)
    for (std::size_t level = 0; level < n_levels(); ++level) {
      const std::size_t i = at(slice, level);
      const std::uint32_t left = credits_[i] - alive_[i] - granted_[i];
      const std::uint32_t share = std::max(left / n_waiting, std::min(left, least_[level]));
      granted_[i] += share;
      held_[queue][i] = share;
      credits[slice].rays[level] = share;
    }
  ++n_holding_;
}

void RayCredits::settle(std::size_t queue, std::span<const layout::Traffic> traffic) {
  for (std::size_t slice = 0; slice < traffic.size(); ++slice)
    for (std::size_t level = 0; level < n_levels(); ++level) {
      const std::size_t i = at(slice, level);
      const std::uint32_t made = traffic[slice].made[level], ended = traffic[slice].ended[level];
      alive_[i] += made;
      alive_[i] -= ended;
      alive_total_ += made;
      alive_total_ -= ended;
      granted_[i] -= held_[queue][i];
      held_[queue][i] = 0;
    }
  --n_holding_;
  ++version_;
}

void RayCredits::depart(std::span<const std::uint32_t> counts) {
  for (std::size_t i = 0; i < counts.size(); ++i) {
    alive_[i] -= counts[i];
    alive_total_ -= counts[i];
    credits_[i] -= counts[i];
  }
}

void RayCredits::arrive(std::span<const std::uint32_t> counts) {
  for (std::size_t i = 0; i < counts.size(); ++i) {
    alive_[i] += counts[i];
    alive_total_ += counts[i];
    credits_[i] += counts[i];
  }
}

std::vector<std::uint32_t> RayCredits::spare() const {
  std::vector<std::uint32_t> spare(credits_.size());
  for (std::size_t i = 0; i < spare.size(); ++i) spare[i] = credits_[i] - alive_[i] - granted_[i];
  return spare;
}

void RayCredits::add_credits(std::span<const std::uint32_t> counts) {
  for (std::size_t i = 0; i < counts.size(); ++i) credits_[i] += counts[i];
  ++version_;
}

void RayCredits::take_credits(std::span<const std::uint32_t> counts) {
  for (std::size_t i = 0; i < counts.size(); ++i) credits_[i] -= counts[i];
}

void CreditDebts::came(int from, std::span<const std::uint32_t> counts) {
  std::int64_t* const debts = &debts_[static_cast<std::size_t>(from) * n_counts_];
  for (std::size_t i = 0; i < counts.size(); ++i) debts[i] += counts[i];
}

void CreditDebts::went(int to, std::span<const std::uint32_t> counts) {
  std::int64_t* const debts = &debts_[static_cast<std::size_t>(to) * n_counts_];
  for (std::size_t i = 0; i < counts.size(); ++i) debts[i] -= counts[i];
}

std::vector<std::uint32_t> CreditDebts::due(int to, std::span<const std::uint32_t> spare,
                                            std::uint64_t least) const {
  const std::int64_t* const debts = &debts_[static_cast<std::size_t>(to) * n_counts_];
  std::vector<std::uint32_t> due(n_counts_);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < n_counts_; ++i) {
    const std::uint32_t most = spare[i] - std::min(spare[i], kept_[i % kept_.size()]);
    sum += due[i] = static_cast<std::uint32_t>(std::clamp<std::int64_t>(debts[i], 0, most));
  }
  return sum < least ? std::vector<std::uint32_t>() : due;
}

std::vector<std::uint32_t> half_of(std::span<const std::uint32_t> spare,
                                   std::span<const std::uint32_t> least) {
  std::vector<std::uint32_t> half(spare.size());
  for (std::size_t i = 0; i < half.size(); ++i)
    if (spare[i] >= 2 * least[i % least.size()]) half[i] = spare[i] / 2;
  return half;
}

}  // namespace kdray::odprt
