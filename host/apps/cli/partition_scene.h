// What    Whether the ranks of this run hold shares of the scene, no rank all of it, as frames in ODPRT
//         allow; and the way to such a share.
// Errors  Those of reading and building the scene in one process, on all ranks.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "accel/prepare/prepared.h"
#include "api/hooks.h"
#include "apps/cli/render_frame.h"

namespace kdray::cli {

// What a rank has of the scene, and what it knows of all of it.
struct PartitionedScene {
  prepare::Prepared prepared;
  std::shared_ptr<const api::WholeScene> whole;
};

// Says so where options that go with ODPRT need the whole scene. All ranks call it.
bool holds_shares(const RenderArgs& o);

// All ranks call it. `check` sees the settings before a tree is built. Nothing: the scene has instances, and
// every rank needs all of it.
std::optional<PartitionedScene> partition_scene(const SceneInput& input, const TreeOptions& tree, bool quiet,
                                                const std::function<void(const scene::Scene&)>& check);

}  // namespace kdray::cli
