// What    Instances that a program adds to a scene: transforms of one prototype, checked and copied.
// Shape   All of them are one geometry. Which mesh of the scene they are of, and what their materials'
//         numbers are there, is given when scenes are made of geometries.
// Errors  kdray::Error, ErrorCode::input: names the array and the element, and says what is wrong:
//         "transforms[7]: a transform that flattens the mesh".
#pragma once

#include <functional>

#include "scene/model/added_geometry.h"

namespace kdray::scene {

AddedGeometry make_added(GeometryId prototype, const Transforms& transforms, const Words& materials,
                         std::size_t n_materials);

// As many transforms as there are instances. Leaves them as they were when it throws.
// ErrorCode::usage where the geometry is none of instances.
void move_instances(AddedGeometry& geometry, const Transforms& transforms);

// Puts them behind those of the scene, as instances of its mesh of that number.
void put_instances(Scene& scene, const AddedGeometry& geometry, std::uint32_t mesh,
                   std::uint32_t first_material);

}  // namespace kdray::scene
