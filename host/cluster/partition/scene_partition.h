// What    A scene that no rank holds whole: each has the primitives of some of its cells, a tree over them,
//         and all that is true of the whole scene.
// Shape   The partitions of all ranks are the scene, each primitive in one of them, with its number in the
//         file and the words that it has where the whole scene is in one place: so the nearest hit of all
//         partitions, of equal ones that of the least number, is the whole scene's. Bounds of partitions may
//         overlap. docs/design/distribute.md
// Errors  The errors of loading the scene in one process, on all ranks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "accel/flatten/core.h"
#include "accel/prepare/prepared.h"
#include "base/box.h"
#include "base/hash.h"
#include "cluster/partition/primitive_set.h"
#include "cluster/transport/together.h"
#include "kdray/options.h"

namespace kdray::partition {

// The cells that a scene is divided into. Each primitive belongs to one of them, by the middle of its
// bounds, and the cells are the same, bit for bit, for any number of ranks. Every cell of more than its
// part of the primitives is split at a plane, level by level. Ranks count their primitives into bins along
// each axis and add the bins up; from the sums each computes the same planes, by the surface-area heuristic
// among those that leave an eighth on either side. Cells come in the order of the splits, so that
// neighbours in the list are neighbours in space. Primitives with one middle are told apart by their
// numbers. Why: Counts, minima and maxima are the same in any order, and every rank computes the planes
// from them in double, by the same steps.
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

struct ScenePartition {
  // `flat` and `wide` are the rank's own: primitives with their numbers in the file, for programs with
  // KDRAY_FEATURE_NUMBERS; settings, space, bounds, counts, features, materials, maps, pictures and lights
  // are the whole scene's. So are tree_nodes (the sum), tree_depth and wide.stack_size (the most) and the
  // size of blocks. `tree` is of the rank's own tree.
  prepare::Prepared prepared;
  flatten::Core core;                  // the whole scene's
  Hash primitives;                     // of the whole scene, whichever ranks hold it (flatten/scene_hash.h)
  std::vector<Cell> cells;             // of the whole scene
  std::vector<std::uint32_t> rank_of;  // of each cell
};

// Reads the file and divides its scene. Every rank calls it, with the same options; there is no binary tree,
// whatever they say. `check` sees the settings before any tree is built. Returns nothing, on all ranks, where
// the scene has instances, which are not divided.
std::optional<ScenePartition> partition_scene(const std::filesystem::path& file, const LoadOptions& load,
                                              const TreeOptions& tree, transport::Together& all,
                                              const std::function<void(const scene::Scene&)>& check = {});

// Divides a scene without instances that every rank has.
ScenePartition partition_scene(const scene::Scene& scene, const TreeOptions& tree, transport::Together& all);

}  // namespace kdray::partition
