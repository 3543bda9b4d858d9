// What    What a rank owes others of its credits (ray_credits.h): rays bring them along, and they go back to
//         where they came from when the rays have ended.
// Shape   Counts by slice and level (ray_credits.h).
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace kdray::odprt {

class CreditDebts {
 public:
  // `kept` by level: what is not given back, since queues here are to have it at once when they want it.
  CreditDebts(std::size_t n_ranks, std::size_t n_slices, std::vector<std::uint32_t> kept)
      : kept_(std::move(kept)), n_counts_(n_slices * kept_.size()), debts_(n_ranks * n_counts_) {}

  void came(int from, std::span<const std::uint32_t> counts);
  void went(int to, std::span<const std::uint32_t> counts);

  // What the rank may have back of what is to spare; nothing where it is less than `least` in all.
  std::vector<std::uint32_t> due(int to, std::span<const std::uint32_t> spare, std::uint64_t least) const;

 private:
  std::vector<std::uint32_t> kept_;
  std::size_t n_counts_;
  std::vector<std::int64_t> debts_;  // by rank; below 0: the other's
};

// Half of the credits to spare, wherever that leaves both a ray's needs: for a rank that can't go on for want
// of some. `least` by level.
std::vector<std::uint32_t> half_of(std::span<const std::uint32_t> spare,
                                   std::span<const std::uint32_t> least);

}  // namespace kdray::odprt
