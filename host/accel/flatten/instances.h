// What    Instances as the kernels read them, their bounds in the scene, and by how much boxes above them
//         have to be widened.
// Shape   A mesh is prepared like a scene, in a space of its own; here are the parts of it that its instances
//         need.
// Errors  The ray in a mesh is another one than the ray in the scene, by rounding
//         (kernels/traverse/instance.clh). A point that it hits there at t lies, in the scene, off the ray's
//         point at t, component by component, by at most
//             |to_world| (6u (|to_mesh| |o - place| + |mesh_place|) + 4u t |to_mesh| |d| + 32u R),
//         where R is the largest distance of the mesh's vertices from the ray's origin in the mesh, and 32u R
//         all that the walk there allows for. With t|d| <= |o - place| + |p - place| and R <= |to_mesh| |o -
//         place| + 2 reach, and c = |to_world| |to_mesh| as largest sums of rows, it is at most
//             42u c D + u |to_world| (72 reach + 10 |mesh_place| + 4 reach),
//         D being the largest component of |o - place|, which the walk's (|o| + |world|) bounds. So boxes
//         above are widened by 2^-19 times the power of two that is no less than 42/32 c, and an instance's
//         own box by the rest, which has nothing to do with the ray: 128u |to_world| reach.
#pragma once

#include <span>
#include <vector>

#include "accel/flatten/wide.h"
#include "base/box.h"
#include "base/local_space.h"
#include "base/memory.h"
#include "layout/instances.layout.h"
#include "scene/model/instances.h"

namespace kdray::flatten {

// A subtree of a mesh, near its root or the root itself.
struct MeshPart {
  std::vector<Box> boxes;          // that cover all of it, more tightly than one would
  std::uint32_t root = 0;          // among the wide nodes
  std::uint32_t first = 0, n = 0;  // of the mesh's parts, those that it can be opened into; none: it can't
};

struct MeshForm {
  LocalSpace space;
  Box bounds;                   // in it
  std::vector<MeshPart> parts;  // [0] is the whole mesh
};

// Returns what the tree over instances needs to know of a mesh's tree: the root, and the nodes near it that
// an instance can be opened into (instance_openings.h). A node whose children are all nodes can be opened,
// down to three levels. Roots are nodes of this form.
std::vector<MeshPart> parts_of(const WideForm& mesh);

struct PlacedInstances {
  Array<layout::Instance> instances;
  std::vector<Box> bounds;  // in the scene's space, widened
  Box all;
  int widen = 1;  // by which the usual widening of boxes is multiplied: a power of two
};

// Throws ErrorCode::input for an instance that the scene's floats can't hold: it is too small or too large
// beside the scene.
PlacedInstances place_instances(std::span<const scene::Instance> instances, std::span<const MeshForm> meshes,
                                const LocalSpace& scene);

// Returns the bounds of a part of an instance's mesh in the scene's space, widened.
Box bounds_of(const MeshPart& part, const scene::Instance& instance, const MeshForm& mesh,
              const LocalSpace& scene);

}  // namespace kdray::flatten
