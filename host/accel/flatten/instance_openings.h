// What    The tree over instances: wide nodes whose children are nodes or instances
//         (kernels/layout/instances.layout.h). Instances that lie close to others are opened: in the tree
//         stand, in an instance's place, the nodes near its mesh's root, each in a box of its own. So a ray
//         passes by what it does not meet, comes to near surfaces of several instances in the order in which
//         they lie, and begins below the mesh's root.
// Shape   Boxes are parted by the surface-area heuristic over bins of their middles, the dearest part first,
//         until a node has eight children; a box is in one node alone, since walking a mesh twice costs more
//         than boxes that overlap. Nodes are in depth-first order, the root first; the same on every machine.
//         An opened instance keeps its place among the instances, by which rays and hits name it; no leaf has
//         it. Its pieces lie behind all instances: the same but for the root, and `whole` is the instance.
//         All of them have the ray with the same bits, so a primitive that lies in two is hit by both alike.
//         An instance is opened where another one's box reaches into the middle of its own, the largest
//         first, as long as there are few leaves in all. What lies by itself, or meets others at its ends,
//         stays whole, since a ray that enters several pieces is moved into the mesh for each.
// Errors  A piece's box holds what is hit in it for the reasons that an instance's does (instances.h), of the
//         boxes in the mesh that are moved: those of the piece.
// Source  Wald, "On fast construction of SAH-based bounding volume hierarchies", RT 2007; Benthin, Woop,
//         Wald, Afra, "Improved two-level BVHs using partial re-braiding", HPG 2017.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/flatten/collapse.h"
#include "accel/flatten/instances.h"
#include "accel/flatten/wide.h"
#include "base/box.h"
#include "layout/wide.layout.h"

namespace kdray::flatten {

struct InstanceTree {
  std::vector<layout::WideNode> nodes;  // children are named from 0
  StackNeeds needs{};                   // what a walk stacks from the root on
};

// Builds the tree over one box or more. `instances`: what each is the box of; none: the one of the same
// number.
InstanceTree build_instance_tree(std::span<const Box> boxes, std::span<const std::uint32_t> instances = {});

// Returns a node of up to eight children whose boxes and words are given.
layout::WideNode node_of(std::span<const Box> boxes, std::span<const layout::u32> children);

// What the tree over instances has a leaf for.
struct InstanceLeaves {
  std::vector<Box> boxes;
  std::vector<std::uint32_t> instances;  // of each: an instance, or a piece of one; none: all are whole
};

// The most leaves that opened instances may lead to: a MiB of instances.
inline constexpr std::size_t kMostPieces = 1 << 13;

// Appends the pieces to the instances of `placed`.
InstanceLeaves open_instances(PlacedInstances& placed, std::span<const scene::Instance> instances,
                              std::span<const MeshForm> meshes, const LocalSpace& scene,
                              std::size_t most = kMostPieces);

// Undoes that, so that a scene can be divided between instances: removes the pieces and builds the tree anew.
void close_instances(FlatScene& flat, WideForm& wide);

}  // namespace kdray::flatten
