// What    The cells of a kd-tree to a depth, as boxes in the scene's own units.
// Shape   Leaves above that depth are cells, too; no more than kMostCells, the upper ones.
#pragma once

#include <cstddef>
#include <vector>

#include "accel/prepare/prepared.h"
#include "base/box.h"

namespace kdray::view {

inline constexpr std::size_t kMostCells = 4096;

// Of a scene with a binary form; none without.
std::vector<DBox> cells_of(const prepare::Prepared& scene, int depth);

}  // namespace kdray::view
