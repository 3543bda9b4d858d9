#include "bench/modes_cut.h"

#include <algorithm>
#include <queue>

namespace kdray::bench {

namespace {

using layout::u32;

constexpr u32 kSlots = 8;

// What the blocks of a kind of primitive are made of.
struct Blocks {
  const Array<u32>& words;
  std::size_t rows;
};

Blocks blocks_of(const flatten::WideForm& form, u32 kind) {
  if (kind == 0) return {form.triangle_blocks, KDRAY_TRIANGLE_ROWS};
  if (kind == 1) return {form.sphere_blocks, KDRAY_SPHERE_ROWS};
  return {form.cone_blocks, KDRAY_CONE_ROWS};
}

bool is_leaf(u32 child) {
  return (child & KDRAY_WIDE_LEAF) != 0;
}

u32 kind_of(u32 child) {
  return child >> KDRAY_WIDE_KIND_SHIFT & 3u;
}

// Of every node: its box, and the expected cost and the bytes of what is below and itself.
struct Sums {
  std::vector<Piece> nodes;

  explicit Sums(const flatten::WideForm& form) : nodes(form.nodes.size()) {
    for (std::size_t i = nodes.size(); i-- > 0;) {  // children come behind their parents
      Piece& sum = nodes[i];
      sum = {static_cast<u32>(i), {}, 0, sizeof(layout::WideNode)};
      for (u32 slot = 0; slot < kSlots; ++slot) {
        if (box_of(form.nodes[i], slot).empty()) continue;
        const Piece below = at(form, static_cast<u32>(i), slot);
        sum.box.grow(below.box);
        sum.cost += below.cost;
        sum.bytes += below.bytes;
      }
      sum.cost += kVisitCost * sum.box.area();
    }
  }

  Piece at(const flatten::WideForm& form, u32 node, u32 slot) const {
    const u32 child = form.nodes[node].child[slot];
    const Box box = box_of(form.nodes[node], slot);
    if (!is_leaf(child)) return {child, box, nodes[child].cost, nodes[child].bytes};
    const u32 n = blocks_of_leaf(form, child);
    const std::size_t words = blocks_of(form, kind_of(child)).rows * static_cast<std::size_t>(form.block);
    return {child, box, kBlockCost * box.area() * n, n * words * sizeof(u32)};
  }
};

// A subtree that may be opened.
struct Waiting {
  double cost;
  u32 node;
};

// The dearest on top; of two equal ones the first.
struct Cheaper {
  bool operator()(const Waiting& a, const Waiting& b) const {
    return a.cost != b.cost ? a.cost < b.cost : a.node > b.node;
  }
};

// Which nodes are opened.
std::vector<bool> opened(const flatten::WideForm& form, const Sums& sums, std::size_t n_wanted) {
  std::vector<bool> is_open(form.nodes.size());
  std::priority_queue<Waiting, std::vector<Waiting>, Cheaper> waiting;
  waiting.push({sums.nodes[0].cost, 0});
  for (std::size_t n = 1; n < n_wanted && !waiting.empty();) {
    const u32 node = waiting.top().node;
    waiting.pop();
    is_open[node] = true;
    --n;
    for (u32 slot = 0; slot < kSlots; ++slot) {
      if (box_of(form.nodes[node], slot).empty()) continue;
      const Piece below = sums.at(form, node, slot);
      if (!is_leaf(below.child)) waiting.push({below.cost, below.child});
      ++n;
    }
  }
  return is_open;
}

}  // namespace

Cut::Cut(const flatten::WideForm& form, std::size_t n_wanted)
    : piece_of_node_(form.nodes.size(), kDirectory), piece_of_slot_(kSlots * form.nodes.size(), kDirectory) {
  if (form.nodes.empty()) return;
  const Sums sums(form);
  const std::vector<bool> is_open = opened(form, sums, n_wanted);
  const auto number = [&](const auto& self, const Piece& piece, std::uint32_t& place) -> void {
    if (is_leaf(piece.child) || !is_open[piece.child]) {
      place = static_cast<u32>(pieces_.size());
      pieces_.push_back(piece);
      return;
    }
    const layout::WideNode& node = form.nodes[piece.child];
    for (u32 nearer = 0; nearer < kSlots; ++nearer) {
      const u32 slot = slot_at(node, 0, nearer);
      if (box_of(node, slot).empty()) continue;
      const u32 child = node.child[slot];
      self(self, sums.at(form, piece.child, slot),
           is_leaf(child) ? piece_of_slot_[std::size_t{kSlots} * piece.child + slot] : piece_of_node_[child]);
    }
  };
  number(number, sums.nodes[0], piece_of_node_[0]);
}

std::uint32_t blocks_of_leaf(const flatten::WideForm& form, layout::u32 child) {
  const Blocks blocks = blocks_of(form, kind_of(child));
  const auto block = static_cast<std::size_t>(form.block);
  std::uint32_t n = 1;
  // A block's last lane tells whether it ends the leaf.
  for (std::size_t at = child & KDRAY_WIDE_FIRST_MASK;; ++at, ++n) {
    const std::size_t last_lane = (at + 1) * (blocks.rows) * block - 1;
    if (last_lane >= blocks.words.size() || (blocks.words[last_lane] & KDRAY_WIDE_LAST) != 0) return n;
  }
}

Box box_of(const layout::WideNode& node, std::uint32_t slot) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lo[axis] = node.bounds[axis][0][slot];
    box.hi[axis] = node.bounds[axis][1][slot];
  }
  return box;
}

std::uint32_t slot_at(const layout::WideNode& node, std::uint32_t octant, std::uint32_t nearer) {
  return node.order[octant] >> (3 * (kSlots - 1 - nearer)) & 7u;
}

}  // namespace kdray::bench
