// What    A wide tree cut into pieces, subtrees of about equal expected cost: what ODPRT gives to queues, here for the model of
//         queues that are not there.
// Shape   Beginning with the root, the subtree of the largest expected cost is opened, its children take its place, until
//         there are enough or nothing is left to open: leaves stay whole. Pieces are in the tree's own order (near to far for
//         rays along +x +y +z), in which neighbours are near each other. What lies above them is the directory.
// Units   An expected cost is surface area times what a walk does there: a visit of a node counts 1, a test of a block 2
//         (TreeOptions' own weights).
#pragma once

#include <cstdint>
#include <vector>

#include "flatten/wide.h"
#include "math/box.h"

namespace kdray::bench {

inline constexpr double kVisitCost = 1, kBlockCost = 2;

struct Piece {
  layout::u32 child = 0;  // as in layout::WideNode
  Box box;
  double cost = 0;
  std::size_t bytes = 0;  // of its nodes and blocks
};

// The directory, as the number of a piece.
inline constexpr std::uint32_t kDirectory = ~0u;

class Cut {
 public:
  // Into at least n_wanted pieces, where the tree has as many.
  Cut(const flatten::WideForm& form, std::size_t n_wanted);

  const std::vector<Piece>& pieces() const { return pieces_; }

  // The piece whose root a node is; for nodes above and below such ones kDirectory.
  std::uint32_t piece_of_node(std::uint32_t node) const { return piece_of_node_[node]; }

  // The piece that a leaf is, which hangs in this slot of an opened node.
  std::uint32_t piece_of_leaf(std::uint32_t node, std::uint32_t slot) const {
    return piece_of_slot_[std::size_t{8} * node + slot];
  }

 private:
  std::vector<Piece> pieces_;
  std::vector<std::uint32_t> piece_of_node_, piece_of_slot_;
};

// Blocks of the leaf that a child names.
std::uint32_t blocks_of_leaf(const flatten::WideForm& form, layout::u32 child);

// The box of a node's slot; empty where it has no child.
Box box_of(const layout::WideNode& node, std::uint32_t slot);

// The slots of a node from near to far, for rays of an octant.
std::uint32_t slot_at(const layout::WideNode& node, std::uint32_t octant, std::uint32_t nearer);

}  // namespace kdray::bench
