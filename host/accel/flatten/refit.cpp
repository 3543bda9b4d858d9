#include "accel/flatten/refit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "accel/flatten/collapse.h"
#include "accel/flatten/leaf_block.h"

namespace kdray::flatten {

namespace {

// Levels at the top of the form, whose nodes let other threads take their children.
constexpr int kShared = 4;

// How many blocks ahead triangles are prefetched.
constexpr std::size_t kAhead = 2;

// What is known of a subtree: its bounds, the sum of its surfaces times their steps, and what a walk stacks.
struct Below {
  Box box;
  double steps = 0;
  StackNeeds needs{};
};
using BelowSlots = std::array<Below, kWidth>;

double surface(const Box& box) {
  const dvec3 e = box.empty() ? dvec3(0) : dvec3(box.hi) - dvec3(box.lo);
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

double cost_of_root(const Below& root) {
  const double all = surface(root.box);
  return all > 0 ? 1 + root.steps / all : 0;
}

// Visits the form's nodes, children before parents. Leaf: returns the bounds and the steps of a child that is
// a leaf, in (node, slot). Done: called for a node, with what is below each of its slots; returns what it
// stacks.
template <class Leaf, class Done>
class FromBelow {
 public:
  FromBelow(const WideForm& form, const Leaf& leaf, const Done& done)
      : form_(form), leaf_(leaf), done_(done) {}

  Below visit(std::size_t index, int level = 0) const {
    const layout::WideNode& node = form_.nodes[index];
    BelowSlots below{};
    const auto visit_slot = [&](std::uint32_t slot) {
      if (!has_child(node, slot)) return;
      if (is_leaf(node.child[slot])) {
        below[slot] = leaf_(node, slot);
      } else {
        below[slot] = visit(node.child[slot], level + 1);
        below[slot].steps += surface(below[slot].box);  // the node's own
      }
    };
    if (level < kShared) {
      tbb::parallel_for(std::uint32_t{0}, kWidth, visit_slot);
    } else {
      for (std::uint32_t slot = 0; slot < kWidth; ++slot) visit_slot(slot);
    }
    Below all;
    all.needs = done_(index, below);
    for (const Below& b : below) {  // in one order, whatever the threads
      all.box.grow(b.box);
      all.steps += b.steps;
    }
    return all;
  }

 private:
  const WideForm& form_;
  const Leaf& leaf_;
  const Done& done_;
};

std::size_t blocks_of_leaf(const WideForm& form, layout::u32 leaf) {
  std::size_t n = 0;
  primitives::with_kind(leaf_kind(leaf), [&](auto kind) {
    using Kind = decltype(kind);
    const auto block = static_cast<std::size_t>(form.block);
    const layout::u32* last =
        Kind::blocks_of(form).data() + ((leaf & KDRAY_WIDE_FIRST_MASK) + 1) * Kind::kRows * block - 1;
    for (n = 1; (*last & KDRAY_WIDE_LAST) == 0; last += Kind::kRows * block) ++n;
  });
  return n;
}

// Returns a leaf that has not moved, with its own bounds.
Below as_it_was(const WideForm& form, const layout::WideNode& node, std::uint32_t slot) {
  const Box box = bounds_of_child(node, slot);
  return {box, surface(box) * static_cast<double>(blocks_of_leaf(form, node.child[slot])), {}};
}

// Writes the leaves of triangles.
class Mover {
 public:
  Mover(const WideForm& from, const Pieces& pieces, const Array<layout::Triangle>& triangles, WideForm& to)
      : from_(from),
        pieces_(pieces),
        triangles_(triangles),
        block_(static_cast<std::uint32_t>(from.block)),
        to_(to) {}

  Below leaf(layout::u32 leaf) const {
    Box box;
    std::size_t n = 0;
    for (bool more = true; more; ++n) {
      const std::size_t i = (leaf & KDRAY_WIDE_FIRST_MASK) + n;
      prefetch(i + kAhead);
      const LeafBlock old(from_.triangle_blocks, i, block_);
      layout::u32* const words = to_.triangle_blocks.data() + i * KDRAY_TRIANGLE_ROWS * block_;
      write(old, words);
      box.grow(bounds_of_pieces(words, pieces_.of_block(i), old.n, block_));
      more = !old.is_last;
    }
    return {box, surface(box) * static_cast<double>(n), {}};
  }

 private:
  // Prefetches the triangles of a block that is written soon: leaves follow each other. (Inlined: g++ takes a
  // function that does nothing else for one without effect, and leaves out calls of it.)
  [[gnu::always_inline]] void prefetch(std::size_t i) const {
    const std::size_t at = (i * KDRAY_TRIANGLE_ROWS + KDRAY_ROW_TRIANGLE_INDEX) * block_;
    if (at + block_ > from_.triangle_blocks.size()) return;
    for (std::size_t lane = 0; lane < block_; ++lane)
      __builtin_prefetch(triangles_.data() + (from_.triangle_blocks[at + lane] & KDRAY_REF_INDEX_MASK));
  }

  void write(const LeafBlock& old, layout::u32* words) const {
    constexpr std::size_t kRows = KDRAY_TRIANGLE_ROWS - 1;  // but for the index
    for (std::uint32_t lane = 0; lane < old.n; ++lane) {
      const auto rows = rows_of(triangles_[old.index(lane)]);
      for (std::size_t r = 0; r < rows.size(); ++r) words[r * block_ + lane] = bits(rows[r]);
      words[kRows * block_ + lane] = old.indices[lane];
    }
    if (old.n < block_) clear_lanes(old.n, block_, kRows, words);
    finish_triangles(triangles_, old.n, block_, words);
  }

  const WideForm& from_;
  const Pieces& pieces_;
  const Array<layout::Triangle>& triangles_;
  const std::uint32_t block_;
  WideForm& to_;
};

}  // namespace

double expected_cost(const WideForm& form) {
  const auto leaf = [&](const layout::WideNode& node, std::uint32_t slot) {
    return as_it_was(form, node, slot);
  };
  const auto done = [](std::size_t, const BelowSlots&) { return StackNeeds{}; };
  return cost_of_root(FromBelow(form, leaf, done).visit(0));
}

Refit refit(const WideForm& form, const Pieces& pieces, const Array<layout::Triangle>& triangles) {
  Refit made;
  WideForm& to = made.form;
  to = form;
  to.nodes = Array<layout::WideNode>(form.nodes.size());
  to.triangle_blocks = Array<layout::u32>(form.triangle_blocks.size());
  const Mover mover(form, pieces, triangles, to);
  const auto leaf = [&](const layout::WideNode& node, std::uint32_t slot) {
    const layout::u32 child = node.child[slot];
    return is_leaf_of<primitives::TriangleKind>(child) ? mover.leaf(child) : as_it_was(form, node, slot);
  };
  const auto done = [&](std::size_t index, const BelowSlots& below) {
    layout::WideNode& out = to.nodes[index];
    out = form.nodes[index];
    std::array<const StackNeeds*, kWidth> needs{};
    std::uint32_t n = 0;
    for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
      set_bounds(out, slot, below[slot].box);
      needs[slot] = &below[slot].needs;
      n += has_child(out, slot) ? 1 : 0;
    }
    order_anew(out, n);
    return needs_of_node(out.order, n, needs);
  };
  const Below root = FromBelow(form, leaf, done).visit(0);
  made.cost = cost_of_root(root);
  to.stack_size = *std::max_element(root.needs.begin(), root.needs.end());
  return made;
}

}  // namespace kdray::flatten
