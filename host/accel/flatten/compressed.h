// What    The wide form's nodes compressed (kernels/layout/compressed.layout.h): three eighths of the bytes,
//         for devices whose walks have one ray to a work-item.
// Errors  A child's box, as the walk sees it, holds the one that it stands for, but for 2^-53 of the node's
//         farthest coordinate: what double is off by where two of its coordinates differ by more than its 53
//         bits hold. That is 2^-29 of the roundoff that boxes are widened by (kernels/traverse/ray.clh).
#pragma once

#include "base/memory.h"
#include "layout/compressed.layout.h"
#include "layout/wide.layout.h"

namespace kdray::flatten {

layout::CompressedNode compressed(const layout::WideNode& node);

// Returns the most nodes that a way down has; one through an instance goes on in its mesh.
int most_levels(const Array<layout::WideNode>& nodes);

Array<layout::CompressedNode> compressed(const Array<layout::WideNode>& nodes);

}  // namespace kdray::flatten
