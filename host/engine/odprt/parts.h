// What    The parts of a divided scene: each holds the wide tree's top as far as it leads to its own
//         subtrees, those subtrees, and the primitives in them; and the directory that tells rays which parts
//         they meet.
// Shape   A primitive that lies in subtrees of several parts is in all of those. A part's triangles begin
//         with such ones, ordered by number, so that a shadow ray from elsewhere can name the one that it
//         left. A mesh is whole in every part that has an instance of it; an instance is in one part.
//         Materials and lights are everywhere.
// Why     The whole form's stack, blocks and boxes stay what they are, so one program serves the whole and
//         every part, and a ray meets in the parts what it would meet in the whole.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/flatten/flatten.h"
#include "accel/flatten/wide.h"
#include "engine/odprt/subtrees.h"
#include "layout/odprt.layout.h"

namespace kdray::odprt {

struct Part {
  flatten::FlatScene flat;  // without a binary tree
  flatten::WideForm wide;
  std::uint32_t n_shared = 0;  // triangles that other parts hold too

  // The bytes of the part's share of the geometry. Materials and lights don't count, since every part has
  // them.
  std::size_t geometry_bytes() const;
};

std::size_t geometry_bytes(const flatten::FlatScene& flat, const flatten::WideForm& wide);

// `part_of` has the part of each subtree.
std::vector<Part> make_parts(const flatten::FlatScene& scene, const flatten::WideForm& form, const Cut& cut,
                             std::span<const std::uint32_t> part_of, std::uint32_t n_parts);

// The bounds of what the parts hold, in the order of parts: of all that a part holds, and behind that, cell
// within cell, of the largest nodes whose contents lie in that part, of what there is of the tree's top
// below, and of the children of the subtrees' roots.
std::vector<layout::PartCell> make_directory(const flatten::WideForm& form, const Cut& cut,
                                             std::span<const std::uint32_t> part_of);

}  // namespace kdray::odprt
