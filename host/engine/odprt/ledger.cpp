#include "engine/odprt/ledger.h"

#include <algorithm>

namespace kdray::odprt {

Ledger::Ledger(std::size_t n_slices, const std::vector<std::uint32_t>& capacity,
               std::vector<std::uint32_t> least, std::size_t n_queues, RankOf rank)
    : least_(std::move(least)),
      alive_(n_slices * capacity.size()),
      granted_(alive_.size()),
      held_(n_queues, std::vector<std::uint32_t>(alive_.size())) {
  for (std::size_t slice = 0; slice < n_slices; ++slice)
    for (const std::uint32_t n : capacity)
      room_.push_back(n / rank.ranks + (rank.rank < n % rank.ranks ? 1 : 0));
}

void Ledger::grant(std::size_t queue, std::span<layout::Grant> grants) {
  // Queues that hold nothing now may want their share.
  const auto n_waiting = static_cast<std::uint32_t>(held_.size() - n_holding_);
  for (std::size_t slice = 0; slice < grants.size(); ++slice)
    for (std::size_t level = 0; level < n_levels(); ++level) {
      const std::size_t i = at(slice, level);
      const std::uint32_t left = room_[i] - alive_[i] - granted_[i];
      const std::uint32_t share = std::max(left / n_waiting, std::min(left, least_[level]));
      granted_[i] += share;
      held_[queue][i] = share;
      grants[slice].rays[level] = share;
    }
  ++n_holding_;
}

void Ledger::settle(std::size_t queue, std::span<const layout::Traffic> traffic) {
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

void Ledger::depart(std::span<const std::uint32_t> counts) {
  for (std::size_t i = 0; i < counts.size(); ++i) {
    alive_[i] -= counts[i];
    alive_total_ -= counts[i];
    room_[i] -= counts[i];
  }
}

void Ledger::arrive(std::span<const std::uint32_t> counts) {
  for (std::size_t i = 0; i < counts.size(); ++i) {
    alive_[i] += counts[i];
    alive_total_ += counts[i];
    room_[i] += counts[i];
  }
}

std::vector<std::uint32_t> Ledger::spare() const {
  std::vector<std::uint32_t> spare(room_.size());
  for (std::size_t i = 0; i < spare.size(); ++i) spare[i] = room_[i] - alive_[i] - granted_[i];
  return spare;
}

void Ledger::add_room(std::span<const std::uint32_t> counts) {
  for (std::size_t i = 0; i < counts.size(); ++i) room_[i] += counts[i];
  ++version_;
}

void Ledger::take_room(std::span<const std::uint32_t> counts) {
  for (std::size_t i = 0; i < counts.size(); ++i) room_[i] -= counts[i];
}

}  // namespace kdray::odprt
