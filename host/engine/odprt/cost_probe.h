// What    A small frame of the whole scene on one queue, which counts how many rays come to each subtree:
//         what the subtrees' costs are estimated by before the scene is divided.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/odprt/division.h"
#include "engine/odprt/render.h"

namespace kdray::odprt {

// `whole` is the scene in one part. Returns the visits and hits of each subtree.
std::vector<SubtreeUse> probe_costs(const Request& request, const Division& whole, const Cut& cut);

}  // namespace kdray::odprt
