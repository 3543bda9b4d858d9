// What    Many of one mesh, side by side in a square: what instances are measured on.
// Shape   Their middles lie on a grid, `apart` times the mesh's largest extent from each other: at 1 they
//         stand side by side, at less they reach into each other. Each is turned about the vertical, and
//         every second one mirrored. Camera and lights are those that a scene without them gets
//         (scene/model/frame.h).
#pragma once

#include "scene/model/scene.h"

namespace kdray::bench {

// The triangles of `mesh`, with one material, across * across times.
// Errors: ErrorCode::input for a scene without triangles.
scene::Scene flock_of(const scene::Scene& mesh, int across, double apart);

}  // namespace kdray::bench
