// What    An outdoor scene: plants on uneven ground, seen by somebody who stands among them.
// Shape   Meshes of a tuft of grass, a shrub and a tree, each seen many times as an instance that is turned
//         and scaled. The ground is the scene's own.
#pragma once

#include "scene/model/scene.h"

namespace kdray::bench {

scene::Scene meadow();

}  // namespace kdray::bench
