// What    Deals the cores of a machine out to the ranks that are on it, so that together they have as many
//         threads as there are cores.
// Shape   Ranks that may run on the same cores of one machine share them equally, each on some of its own
//         where there are enough; a rank that is alone on its cores keeps them all. What the launcher has
//         bound a rank to stays its own. Threads of the host follow by themselves; PoCL, which counts the
//         machine's cores, is told by a variable of its own, unless the user has set it.
// Threads Before any thread that is to work, and before OpenCL is asked.
#pragma once

#include <vector>

#include "cluster/transport/ranks.h"

namespace kdray::cli {

void share_cores(transport::Ranks& ranks);

// Of these cores, those for the rank with number `index` of `n` that have the same: at least one, and others'
// too where there are too few.
std::vector<int> cores_of(const std::vector<int>& cores, std::size_t index, std::size_t n);

}  // namespace kdray::cli
