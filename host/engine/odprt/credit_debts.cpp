#include "engine/odprt/credit_debts.h"

#include <algorithm>

namespace kdray::odprt {

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
