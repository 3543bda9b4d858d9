// What    The normals of stitches (scene/stitches.h) of a scene that is in shares: a neighbour may be
//         anybody's.
// Memory  All stitches of the scene, on every rank.
#pragma once

#include "cluster/partition/primitive_set.h"
#include "cluster/transport/together.h"

namespace kdray::partition {

// Gives the bare stitches of all shares the normals that they have in the whole scene.
void settle_stitches(PrimitiveSet& set, transport::Together& all);

}  // namespace kdray::partition
