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

}  // namespace kdray::pdprt
