// What    An affine placement of geometry read from another file or given inline.
// Errors  apply_transform throws std::domain_error with what is wrong when a scene with shapes (spheres, ...)
//         meets a transform that would make ellipsoids of them; the caller knows the file and the place in
//         it.
#pragma once

#include "base/vec.h"
#include "scene/model/scene.h"

namespace kdray::scene {

// Moves vertices, normals and shapes. Normals stay perpendicular to their surface (inverse transpose)
// and of unit length; a mirroring transform turns the triangles over, so that their front stays where the
// normals point.
void apply_transform(const dmat4& m, Scene& scene);

dmat4 translation(const dvec3& by);
dmat4 scaling(const dvec3& by);
dmat4 rotation(const dvec3& unit_axis, double radians);  // right-handed

}  // namespace kdray::scene
