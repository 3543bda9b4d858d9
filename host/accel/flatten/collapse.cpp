#include "accel/flatten/collapse.h"

#include <algorithm>
#include <array>

#include "accel/flatten/openings.h"
#include "base/error.h"

namespace kdray::flatten {

namespace {

using primitives::kKinds;
constexpr std::uint32_t kNone = ~0u;

// A subtree, or, of a leaf, its references of one kind.
struct Child {
  Subtree subtree;
  std::uint32_t kind = kNone;  // kNone: a wide node of its own
};

// For each octant of directions: slots from far to near, 3 bits each, the farthest lowest.
struct Orders {
  std::array<layout::u32, 8> words;
  std::uint32_t n;

  static Orders of_one(std::uint32_t slot) {
    Orders one;
    one.words.fill(slot);
    one.n = 1;
    return one;
  }

  void put_nearer(const Orders& o) {
    for (std::size_t octant = 0; octant < 8; ++octant) words[octant] |= o.words[octant] << (3 * n);
    n += o.n;
  }

  // `below` is the nearer one for directions that are positive along the axis.
  static Orders of_two(const Orders& below, const Orders& above, std::uint32_t axis) {
    Orders both;
    both.n = below.n + above.n;
    for (std::size_t octant = 0; octant < 8; ++octant) {
      const layout::u32 reversed = 0u - (static_cast<layout::u32>(octant) >> axis & 1u);
      const layout::u32 above_nearer = below.words[octant] | above.words[octant] << (3 * below.n);
      const layout::u32 below_nearer = above.words[octant] | below.words[octant] << (3 * above.n);
      both.words[octant] = (above_nearer & reversed) | (below_nearer & ~reversed);
    }
    return both;
  }
};

// The children of one wide node.
class Children {
 public:
  Children(const kdtree::Tree& tree, const Openings& openings, std::uint32_t only_kind)
      : tree_(tree), openings_(openings), only_kind_(only_kind) {}

  // Gathers the children of the node that the subtree becomes; returns the orders' words.
  std::array<layout::u32, 8> gather(const Subtree& root) {
    n_ = 0;
    const Orders found = is_empty(root.node) ? Orders{} : gather(root, kWidth);
    // Slots without child are the farthest.
    Orders whole{};
    for (std::uint32_t slot = kWidth; slot-- > n_;) whole.put_nearer(Orders::of_one(slot));
    whole.put_nearer(found);
    return whole.words;
  }

  std::uint32_t size() const { return n_; }
  const Child& operator[](std::uint32_t slot) const { return children_[slot]; }

 private:
  bool is_empty(std::uint32_t node) const { return tree_.contents[node].empty(); }

  // Adds what fills up to so many slots.
  Orders gather(Subtree s, std::uint32_t n_slots) {
    s = without_empty_cells(s);
    const kdtree::Node& node = tree_.nodes[s.node];
    if (node.is_leaf()) return gather_leaf(s, n_slots);
    const std::uint32_t below = openings_.share_below(s.node, n_slots);
    if (below == 0) return add({s, kNone});
    const Orders nearer = gather({node.left, node.right}, below);
    return Orders::of_two(nearer, gather({node.right, s.end}, n_slots - below), node.order_axis());
  }

  // A leaf's kinds come in one order for all directions.
  Orders gather_leaf(const Subtree& leaf, std::uint32_t n_slots) {
    if (only_kind_ != kAnyKind) return add({leaf, only_kind_});
    if (n_kinds(tree_, leaf.node) > n_slots) return add({leaf, kNone});
    Orders all{};
    for (std::uint32_t kind = kKinds; kind-- > 0;)
      if (leaf_run(tree_, leaf.node, kind).n > 0) all.put_nearer(add({leaf, kind}));
    return all;
  }

  // Follows splits of which only one side holds something.
  Subtree without_empty_cells(Subtree s) const {
    for (;;) {
      const kdtree::Node& node = tree_.nodes[s.node];
      if (node.is_leaf()) return s;
      if (is_empty(node.left)) {
        s = {node.right, s.end};
      } else if (is_empty(node.right)) {
        s = {node.left, node.right};
      } else {
        return s;
      }
    }
  }

  Orders add(const Child& child) {
    children_[n_] = child;
    return Orders::of_one(n_++);
  }

  const kdtree::Tree& tree_;
  const Openings& openings_;
  const std::uint32_t only_kind_;
  std::array<Child, kWidth> children_;
  std::uint32_t n_ = 0;
};

class Collapse {
 public:
  Collapse(const kdtree::Tree& tree, const Openings& openings, std::uint32_t block, std::uint32_t only_kind,
           std::uint32_t cut_at, CollapsedPart& out)
      : tree_(tree),
        block_(block),
        only_kind_(only_kind),
        cut_at_(cut_at),
        children_(tree, openings, only_kind),
        out_(out) {}

  void run(const Subtree& root) {
    out_.nodes.reserve(root.size() / 4 + 1);
    out_.nodes.emplace_back();
    fill(0, root);
  }

 private:
  // Writes the node and the nodes below it. Recursion is no deeper than the binary tree.
  void fill(std::size_t index, const Subtree& root) {
    CollapsedNode node;
    node.order = children_.gather(root);
    node.n = children_.size();
    std::array<Subtree, kWidth> inner;
    std::uint32_t n_inner = 0;
    const std::size_t first = out_.nodes.size();
    for (std::uint32_t slot = 0; slot < node.n; ++slot) {
      const Child& child = children_[slot];
      node.item[slot] = child.subtree.node;
      if (child.kind != kNone) {
        node.child[slot] = leaf_word(child);
      } else if (child.subtree.size() <= cut_at_) {
        node.child[slot] = CollapsedPart::kCut | static_cast<layout::u32>(out_.cuts.size());
        out_.cuts.push_back(child.subtree);
      } else {
        node.child[slot] = static_cast<layout::u32>(first + n_inner);
        inner[n_inner++] = child.subtree;
      }
    }
    if (first + n_inner > KDRAY_WIDE_NODE_MAX)
      throw Error(ErrorCode::input, "the kd-tree has over 2^29 wide nodes");
    out_.nodes.resize(first + n_inner);
    out_.nodes[index] = node;
    for (std::uint32_t i = 0; i < n_inner; ++i) fill(first + i, inner[i]);
  }

  layout::u32 leaf_word(const Child& child) {
    std::size_t& n = out_.n_blocks[child.kind];
    const auto first = static_cast<layout::u32>(n);
    const std::uint32_t leaf = child.subtree.node;
    const std::uint32_t n_refs =
        only_kind_ != kAnyKind ? tree_.nodes[leaf].right : leaf_run(tree_, leaf, child.kind).n;
    n += (n_refs + block_ - 1) / block_;
    if (n > KDRAY_WIDE_FIRST_MASK)
      throw Error(ErrorCode::input, "the kd-tree has over 2^27 leaf blocks of one kind");
    return KDRAY_WIDE_LEAF | child.kind << KDRAY_WIDE_KIND_SHIFT | first;
  }

  const kdtree::Tree& tree_;
  const std::uint32_t block_, only_kind_, cut_at_;
  Children children_;
  CollapsedPart& out_;
};

}  // namespace

kdtree::RefRun leaf_run(const kdtree::Tree& tree, std::uint32_t leaf, std::uint32_t kind) {
  const kdtree::Node& node = tree.nodes[leaf];
  std::uint32_t first = node.left, end = node.left + node.right;
  const auto kind_at = [&](std::uint32_t i) {
    return static_cast<std::uint32_t>(kdtree::ref_kind(tree.refs[i]));
  };
  while (first < end && kind_at(first) < kind) ++first;
  while (first < end && kind_at(end - 1) > kind) --end;
  return {first, end - first};
}

CollapsedPart collapse(const kdtree::Tree& tree, const Openings& openings, const Subtree& root,
                       std::uint32_t block, std::uint32_t only_kind, std::uint32_t cut_at) {
  CollapsedPart part;
  Collapse(tree, openings, block, only_kind, cut_at, part).run(root);
  return part;
}

// A walk pushes the children that it meets, at most all n of the node, far to near, and pops the nearest.
// While it is below a child, only those behind that child are left of the node's: so a subtree needs the most
// of n and, over its children, of the number behind plus what the child's subtree needs. Rays of an octant
// share one order, so this is summed up for each octant, children before parents; a leaf pushes nothing.
StackNeeds stack_needs(const CollapsedPart& part, const std::vector<StackNeeds>& cuts) {
  constexpr StackNeeds kNothing{};
  std::vector<StackNeeds> needs(part.nodes.size());
  for (std::size_t i = part.nodes.size(); i-- > 0;) {
    const CollapsedNode& node = part.nodes[i];
    std::array<const StackNeeds*, kWidth> below;  // each child's
    for (std::uint32_t slot = 0; slot < node.n; ++slot) {
      const layout::u32 child = node.child[slot];
      const bool cut = (child & CollapsedPart::kCut) != 0;
      below[slot] = child & KDRAY_WIDE_LEAF ? &kNothing
                    : cut                   ? &cuts[child & ~CollapsedPart::kCut]
                                            : &needs[child];
    }
    needs[i] = needs_of_node(node.order, node.n, below);
  }
  return needs.front();
}

namespace {

// For each pair of children (a, b) the octants, as bits, in which a goes before b.
using Before = std::array<std::array<std::uint8_t, kWidth>, kWidth>;

// The octants whose rays go upward along an axis.
constexpr std::uint8_t kUpward[3] = {0x55, 0x33, 0x0f};

Before pairs_of(const layout::WideNode& node, std::uint32_t n) {
  Before before{};
  for (std::uint32_t a = 0; a + 1 < n; ++a) {
    std::array<float, kWidth> most;  // by how much a lies before b, or b before a
    std::array<std::uint8_t, kWidth> octants{};
    most.fill(-0x1p127f);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float* const lo = node.bounds[axis][0];
      const float* const hi = node.bounds[axis][1];
      for (std::uint32_t b = 0; b < kWidth; ++b) {
        const float below = lo[b] - hi[a], above = lo[a] - hi[b], apart = std::max(below, above);
        const std::uint8_t upward = kUpward[axis];
        const auto here = static_cast<std::uint8_t>(below >= above ? upward : ~upward);
        octants[b] = apart > most[b] ? here : octants[b];
        most[b] = std::max(most[b], apart);
      }
    }
    for (std::uint32_t b = a + 1; b < n; ++b) {
      before[a][b] = octants[b];
      before[b][a] = static_cast<std::uint8_t>(~octants[b]);
    }
  }
  return before;
}

}  // namespace

// Rays of the opposite octant go the other way along every axis: their order is the same from behind.
void order_anew(layout::WideNode& node, std::uint32_t n) {
  if (n < 2) return;
  const Before before = pairs_of(node, n);
  for (std::uint32_t octant = 0; octant < 4; ++octant) {
    std::array<std::uint32_t, kWidth> near_to_far;
    for (std::uint32_t i = 0; i < n; ++i) near_to_far[i] = node.order[octant] >> (3 * (kWidth - 1 - i)) & 7u;
    for (std::uint32_t i = 1; i < n; ++i)
      for (std::uint32_t j = i; j > 0 && before[near_to_far[j]][near_to_far[j - 1]] >> octant & 1u; --j)
        std::swap(near_to_far[j], near_to_far[j - 1]);
    // Slots without child stay the farthest.
    constexpr std::uint32_t kAll = 0xffffffu;
    const layout::u32 empty = node.order[octant] & (kAll >> (3 * n));
    layout::u32 order = empty, opposite = empty;
    for (std::uint32_t i = 0; i < n; ++i) {
      order |= near_to_far[i] << (3 * (kWidth - 1 - i));
      opposite |= near_to_far[n - 1 - i] << (3 * (kWidth - 1 - i));
    }
    node.order[octant] = order;
    node.order[7 - octant] = opposite;
  }
}

}  // namespace kdray::flatten
