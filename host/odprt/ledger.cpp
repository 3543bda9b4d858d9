#include "odprt/ledger.h"

#include <algorithm>

namespace kdray::odprt {

Ledger::Ledger(std::size_t n_slices, std::vector<std::uint32_t> capacity, std::vector<std::uint32_t> least,
               std::size_t n_queues)
    : capacity_(std::move(capacity)),
      least_(std::move(least)),
      alive_(n_slices * capacity_.size()),
      granted_(alive_.size()),
      held_(n_queues, std::vector<std::uint32_t>(alive_.size())) {}

void Ledger::grant(std::size_t queue, std::span<layout::Grant> grants) {
  // Queues that hold nothing now may want their share.
  const auto n_waiting = static_cast<std::uint32_t>(held_.size() - n_holding_);
  for (std::size_t slice = 0; slice < grants.size(); ++slice)
    for (std::size_t level = 0; level < capacity_.size(); ++level) {
      const std::size_t i = at(slice, level);
      const std::uint32_t left = capacity_[level] - alive_[i] - granted_[i];
      const std::uint32_t share = std::max(left / n_waiting, std::min(left, least_[level]));
      granted_[i] += share;
      held_[queue][i] = share;
      grants[slice].rays[level] = share;
    }
  ++n_holding_;
}

void Ledger::settle(std::size_t queue, std::span<const layout::Traffic> traffic) {
  for (std::size_t slice = 0; slice < traffic.size(); ++slice)
    for (std::size_t level = 0; level < capacity_.size(); ++level) {
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

}  // namespace kdray::odprt
