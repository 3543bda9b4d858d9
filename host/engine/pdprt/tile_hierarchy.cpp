#include "engine/pdprt/tile_hierarchy.h"

#include <algorithm>
#include <cmath>

namespace kdray::pdprt {

TileHierarchy::TileHierarchy(int n_ranks, int ranks_to_a_bag)
    : n_ranks_(n_ranks),
      group_(n_ranks <= ranks_to_a_bag ? 1 : static_cast<int>(std::ceil(std::sqrt(n_ranks)))) {}

std::vector<int> TileHierarchy::clients_of(int rank) const {
  std::vector<int> clients;
  if (rank % group_ == 0)
    for (int of_group = rank + 1; of_group < std::min(rank + group_, n_ranks_); ++of_group)
      clients.push_back(of_group);
  if (rank == 0)
    for (int leader = group_; leader < n_ranks_; leader += group_) clients.push_back(leader);
  return clients;
}

int TileHierarchy::n_served_by(int rank) const {
  if (rank == 0) return n_ranks_;
  return rank % group_ == 0 ? std::min(group_, n_ranks_ - rank) : 1;
}

namespace {

constexpr double kCare = 2;                // times the round trip: the next one may take longer
constexpr double kLeastRoundTrip = 0.001;  // seconds: ranks don't look for messages all the time
constexpr double kForgets = 0.25;          // of what the last round trips took, with each new one

}  // namespace

// Tiles that the queues render in that time, by what they have done so far: of what they took last they may
// be at the beginning.
std::size_t PrefetchPolicy::during(double seconds, std::size_t not_done, double now) const {
  if (!any_ || now <= since_) return 1;
  const double done = static_cast<double>(n_granted_ - std::min(not_done, n_granted_));
  return std::max<std::size_t>(static_cast<std::size_t>(done / (now - since_) * seconds), 1);
}

std::optional<std::size_t> PrefetchPolicy::ask(std::size_t stock, std::size_t usual, std::size_t in_work,
                                               double now) {
  if (asked_) return std::nullopt;
  const std::size_t on_the_way = during(kCare * round_trip_, stock + in_work, now);
  if (stock > std::max(usual, on_the_way)) return std::nullopt;
  asked_ = true;
  asked_at_ = now;
  return on_the_way;
}

void PrefetchPolicy::granted(std::size_t n, double now) {
  asked_ = false;
  round_trip_ = std::max({round_trip_ * (1 - kForgets), now - asked_at_, kLeastRoundTrip});
  if (!any_) since_ = now;
  any_ = true;
  n_granted_ += n;
}

}  // namespace kdray::pdprt
