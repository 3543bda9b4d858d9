// What    The splits of the thesis that look at no costs, for comparison: the middle of the cell, the median
//         of what it holds.
// Shape   A leaf is made of kMedianLeaf references or fewer, one full block of the wide form; else where the
//         depth or the budget is used up, or no plane of the rule separates anything.
// Source  Kaplan 1985 (spatial median); Bentley 1975 (object median).
#pragma once

#include <span>

#include "accel/kdtree/sah.h"

namespace kdray::kdtree {

inline constexpr std::size_t kMedianLeaf = 8;

// Which of the medians is meant is BuildConfig::split_rule's to say; it must not be SplitRule::sah.
Split median_split(std::span<const BoundedRef> refs, const Bounds& cell, SplitRule rule);

}  // namespace kdray::kdtree
