// What    Deals subtrees in a row to queues, each a run of neighbours, such that the queue with the most to do has the least
//         possible, and none holds more than `most_bytes`, if that is possible at all; else that is raised until it is.
// Source  Linear partitioning; the least limit is found by bisection, runs are filled up to it from the left.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace kdray::bench {

// The queue of each, ascending from 0; queues are left over where there are fewer things.
std::vector<std::uint32_t> deal(std::span<const double> costs, std::span<const double> bytes,
                                std::uint32_t n_queues, double most_bytes);

}  // namespace kdray::bench
