// What    A hash of what a ray can meet in a scene, and how it looks, that is the same however the scene is
//         divided among ranks.
// Shape   The sum of hashes of primitives, with all that belongs to each; and of what every rank has.
#pragma once

#include "base/hash.h"
#include "flatten/flatten.h"
#include "transport/together.h"

namespace kdray::distribute {

// `flat` is this rank's part; a scene in one piece is the part of the only rank.
Hash scene_hash(const flatten::FlatScene& flat, transport::Together& all);

}  // namespace kdray::distribute
