// What    Instances that lie close to others are opened: in the tree over instances stand, in an instance's
//         stead, the nodes near its mesh's root, each in a box of its own. So a ray passes by what it has no
//         business in, comes to near surfaces of several instances in the order in which they lie, and begins
//         below the mesh's root.
// Shape   An opened instance keeps its place among the instances, by which rays and hits name it; no leaf has
//         it. Its pieces lie behind all instances: the same but for the root, and `whole` is the instance.
//         All of them have the ray with the same bits, so a primitive that lies in two is hit by both alike.
//         Opened is what another instance's box reaches into the middle of, the largest first, as long as
//         there are few leaves in all. What lies by itself, or meets others at its ends, stays whole, since a
//         ray that enters several pieces is moved into the mesh for each.
// Errors  A piece's box holds what is hit in it for the reasons that an instance's does (instances.h), of
//         the boxes in the mesh that are moved: those of the piece.
// Source  Benthin, Woop, Wald, Afra, "Improved two-level BVHs using partial re-braiding", HPG 2017.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/flatten/instances.h"
#include "accel/flatten/wide.h"

namespace kdray::flatten {

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

// Takes it back, for who has to divide a scene between instances: without pieces, with a tree anew.
void close_instances(FlatScene& flat, WideForm& wide);

}  // namespace kdray::flatten
