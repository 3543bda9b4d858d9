// What    The cells that a scene is divided into. Each primitive belongs to one of them, by the middle of its
//         bounds, and the cells are the same, bit for bit, for any number of ranks.
// Shape   Every cell of more than its part of the primitives is split at a plane, level by level. Ranks count
//         their primitives into bins along each axis and add the bins up; from the sums each computes the
//         same planes, by the surface-area heuristic among those that leave an eighth on either side. Cells
//         come in the order of the splits, so that neighbours in the list are neighbours in space. Primitives
//         with one middle are told apart by their numbers.
// Why     Counts, minima and maxima are the same in any order, and every rank computes the planes from them
//         in double, by the same steps.
#pragma once

#include <cstdint>
#include <vector>

#include "base/box.h"
#include "cluster/partition/primitive_set.h"
#include "cluster/transport/together.h"

namespace kdray::partition {

struct Cell {
  std::uint64_t n = 0;  // primitives
  Box bounds;           // of them
};

struct Cells {
  std::vector<Cell> cells;
  std::vector<std::uint32_t> cell_of;  // of each of the rank's primitives, in the order of for_each_box()
};

// Divides into about `n_cells` cells: no cell has more than one in `n_cells` of the primitives, and there are
// at most a few times as many cells.
Cells divide_into_cells(const PrimitiveSet& set, std::uint64_t n_cells, transport::Together& all);

// Returns how many cells a scene of n primitives gets.
std::uint64_t cells_for(std::uint64_t n);

// Returns the rank of each cell: runs of neighbours, with about as many primitives each.
std::vector<std::uint32_t> assign_cells(const std::vector<Cell>& cells, int ranks);

}  // namespace kdray::partition
