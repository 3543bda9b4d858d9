// What    Deals things in a row to queues, each a run of neighbours, such that the queue with the most has the least possible.
// Source  Linear partitioning; the limit is found by bisection, runs are filled up to it from the left.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace kdray::bench {

// The queue of each, ascending from 0; queues are left over where there are fewer things.
std::vector<std::uint32_t> deal(std::span<const double> costs, std::uint32_t n_queues);

}  // namespace kdray::bench
