// What    The normals of zero-area triangles (scene/model/zero_area.h) in a scene that is in shares: a
//         neighbour may be any rank's.
// Memory  All zero-area triangles of the scene, on every rank.
#pragma once

#include "cluster/partition/primitive_set.h"
#include "cluster/transport/together.h"

namespace kdray::partition {

// Gives the zero-area triangles without normals, in all shares, those that they have in the whole scene.
void settle_zero_area(PrimitiveSet& set, transport::Together& all);

}  // namespace kdray::partition
