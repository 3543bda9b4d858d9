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
#include "base/hash.h"
#include "cluster/partition/cells.h"
#include "cluster/transport/together.h"
#include "kdray/options.h"

namespace kdray::partition {

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
