// What    What is known of the surface at a hit, from the reference that the kernels name it by
//         (tree.layout.h).
// Shape   In the scene's own space, in double.
// Errors  ErrorCode::internal for a kind that there is none of.
#pragma once

#include <cstdint>

#include "flatten/flatten.h"
#include "math/vec.h"

namespace kdray::query {

// The primitive's place in file order.
std::uint32_t number_of(const flatten::FlatScene& scene, std::uint32_t ref);

// Of unit length, at a point on the primitive: of a triangle to the side from which its corners run
// counterclockwise, of a sphere outward, of a cone away from its axis, of a disc as it was given. 0 for a
// triangle without area.
dvec3 normal_at(const flatten::FlatScene& scene, std::uint32_t ref, const dvec3& point);

}  // namespace kdray::query
