// What    What of a mesh's tree the tree over instances is to know: the root, and the nodes near it that an
//         instance can be opened into (instance_openings.h).
// Shape   A node whose children are nodes, all of them, can be opened; at most three times one after the
//         other.
#pragma once

#include <vector>

#include "accel/flatten/instances.h"
#include "accel/flatten/wide.h"

namespace kdray::flatten {

// Roots are nodes of this form.
std::vector<MeshPart> parts_of(const WideForm& mesh);

}  // namespace kdray::flatten
