// What    A hash of all that a ray can meet in a scene, and how it looks: not of the tree, which changes no
//         hit. It is the same however the primitives are divided among processes.
// Shape   The sum of hashes of primitives, each with all that belongs to it; and a hash of that and of
//         everything else.
#pragma once

#include "accel/flatten/flatten.h"
#include "base/hash.h"

namespace kdray::flatten {

inline void add(Hash& sum, const Hash& one) {
  sum.high += one.high;
  sum.low += one.low;
}

// Hashes all primitives. For a scene in parts, the parts' hashes add up to the whole scene's.
Hash hash_of_primitives(const FlatScene& flat);

// Hashes the scene: `primitives` is the hash of the whole scene's, of which `flat` may be a part.
Hash scene_hash(const Hash& primitives, const FlatScene& flat);

}  // namespace kdray::flatten
