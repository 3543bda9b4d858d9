// What    A tree over instances: wide nodes whose children are nodes or instances
//         (kernels/layout/instances.layout.h).
// Shape   Boxes are parted by the surface-area heuristic over bins of their middles, the dearest part first,
//         until a node has eight children; a box is in one node alone, since walking a mesh twice costs more
//         than boxes that overlap. Nodes are in depth-first order, the root first; the same on every
//         machine.
// Source  Wald, "On fast construction of SAH-based bounding volume hierarchies", RT 2007.
#pragma once

#include <span>
#include <vector>

#include "accel/flatten/collapse.h"
#include "base/box.h"
#include "layout/wide.layout.h"

namespace kdray::flatten {

struct InstanceTree {
  std::vector<layout::WideNode> nodes;  // children are named from 0
  StackNeeds needs{};                   // what a walk stacks from the root on
};

// At least one box. `instances`: what each is the box of; none: the one of the same number.
InstanceTree build_instance_tree(std::span<const Box> boxes, std::span<const std::uint32_t> instances = {});

// A node of up to eight children whose boxes and words are given.
layout::WideNode node_of(std::span<const Box> boxes, std::span<const layout::u32> children);

}  // namespace kdray::flatten
