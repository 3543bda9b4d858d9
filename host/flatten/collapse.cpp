#include "flatten/collapse.h"

#include <algorithm>

#include "base/error.h"

namespace kdray::flatten {

namespace {

constexpr std::uint32_t kKinds = 3;
constexpr std::uint32_t kNone = ~0u;

// What may become a child: a subtree, or, of a leaf, its references of one kind.
struct Item {
  Subtree subtree;
  std::uint32_t kind = kNone;  // kNone: not a leaf of one kind, so it can be opened
  float area = 0;
  std::uint32_t n_inside = 0;  // what it would be opened into
  // What it was opened into, nearest first for directions that are positive along `axis`.
  std::uint32_t n_parts = 0, first_part = 0;
  std::uint32_t axis = kdtree::Node::kLeaf;  // kLeaf: one order for all directions

  bool is_closed() const { return kind != kNone; }
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

// The items of one wide node: those that were opened, and those that are its children.
class Opening {
 public:
  Opening(const kdtree::Tree& tree, std::uint32_t only_kind) : tree_(tree), only_kind_(only_kind) {}

  void run(const Subtree& root) {
    n_items_ = n_children_ = 0;
    if (add(root)) children_[n_children_++] = 0;
    while (open_largest()) {
    }
  }

  std::uint32_t n_children() const { return n_children_; }
  const Item& child(std::uint32_t slot) const { return items_[children_[slot]]; }

  // Parts have larger numbers than what they are parts of.
  std::array<layout::u32, 8> orders() const {
    std::array<Orders, kMost> orders;  // only those of items are set and read
    for (std::uint32_t slot = 0; slot < n_children_; ++slot) orders[children_[slot]] = Orders::of_one(slot);
    for (std::uint32_t i = n_items_; i-- > 0;)
      if (items_[i].n_parts > 0) orders[i] = orders_of_parts(items_[i], orders);
    // Slots without child are the farthest.
    Orders whole{};
    for (std::uint32_t slot = kWidth; slot-- > n_children_;) whole.put_nearer(Orders::of_one(slot));
    if (n_items_ > 0) whole.put_nearer(orders[0]);
    return whole.words;
  }

 private:
  // Seven openings at most, each into three parts at most.
  static constexpr std::uint32_t kMost = 32;

  bool is_empty(std::uint32_t node) const { return tree_.contents[node].empty(); }

  bool add(Subtree subtree) {
    if (is_empty(subtree.node)) return false;
    subtree = without_empty_cells(subtree);
    const kdtree::Node& node = tree_.nodes[subtree.node];
    Item& item = items_[n_items_++];
    item = {subtree, kNone, tree_.contents[subtree.node].area(), 2, 0, 0, node.axis};
    if (!node.is_leaf()) return true;
    if (only_kind_ != kAnyKind) {
      item.kind = only_kind_;
      return true;
    }
    const std::uint32_t first = kind_at(node.left), last = kind_at(node.left + node.right - 1);
    if (first == last) item.kind = first;
    item.n_inside = n_kinds(subtree.node);
    return true;
  }

  // Where only one side of a split holds something, what is there.
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

  std::uint32_t kind_at(std::uint32_t ref) const {
    return static_cast<std::uint32_t>(kdtree::ref_kind(tree_.refs[ref]));
  }

  // False when the node is full or only leaves are left.
  bool open_largest() {
    std::uint32_t best = kNone;
    float best_area = -1;
    for (std::uint32_t slot = 0; slot < n_children_; ++slot) {
      const Item& item = child(slot);
      if (item.is_closed() || item.area <= best_area || n_children_ - 1 + item.n_inside > kWidth) continue;
      best = slot;
      best_area = item.area;
    }
    if (best == kNone) return false;
    open(children_[best]);
    const Item& opened = child(best);
    for (std::uint32_t part = 1; part < opened.n_parts; ++part)
      children_[n_children_++] = opened.first_part + part;
    children_[best] = opened.first_part;
    return true;
  }

  std::uint32_t n_kinds(std::uint32_t leaf) const {
    std::uint32_t n = 0;
    for (std::uint32_t kind = 0; kind < kKinds; ++kind) n += leaf_run(tree_, leaf, kind).n > 0 ? 1 : 0;
    return n;
  }

  void open(std::uint32_t index) {
    const Subtree subtree = items_[index].subtree;
    const kdtree::Node& node = tree_.nodes[subtree.node];
    const std::uint32_t first = n_items_;
    if (node.is_leaf()) {
      for (std::uint32_t kind = 0; kind < kKinds; ++kind)
        if (leaf_run(tree_, subtree.node, kind).n > 0)
          items_[n_items_++] = {subtree, kind, 0, 0, 0, 0, kdtree::Node::kLeaf};
    } else {
      add({node.left, node.right});
      add({node.right, subtree.end});
    }
    items_[index].first_part = first;
    items_[index].n_parts = n_items_ - first;
  }

  // A leaf's kinds come in one order for all directions.
  static Orders orders_of_parts(const Item& item, const std::array<Orders, kMost>& orders) {
    if (item.axis != kdtree::Node::kLeaf)
      return Orders::of_two(orders[item.first_part], orders[item.first_part + 1], item.axis);
    Orders all{};
    for (std::uint32_t k = item.n_parts; k-- > 0;) all.put_nearer(orders[item.first_part + k]);
    return all;
  }

  const kdtree::Tree& tree_;
  const std::uint32_t only_kind_;
  std::array<Item, kMost> items_;
  std::array<std::uint32_t, kWidth> children_{};
  std::uint32_t n_items_ = 0, n_children_ = 0;
};

class Collapse {
 public:
  Collapse(const kdtree::Tree& tree, std::uint32_t block, std::uint32_t only_kind, std::uint32_t cut_at,
           CollapsedPart& out)
      : tree_(tree),
        block_(block),
        only_kind_(only_kind),
        cut_at_(cut_at),
        opening_(tree, only_kind),
        out_(out) {}

  void run(const Subtree& root) {
    out_.nodes.reserve(root.size() / 4 + 1);
    out_.nodes.emplace_back();
    fill(0, root);
  }

 private:
  // Writes the node and the nodes below it. Recursion is no deeper than the binary tree.
  void fill(std::size_t index, const Subtree& root) {
    opening_.run(root);
    CollapsedNode node;
    node.n = opening_.n_children();
    node.order = opening_.orders();
    std::array<Subtree, kWidth> inner;
    std::uint32_t n_inner = 0;
    const std::size_t first = out_.nodes.size();
    for (std::uint32_t slot = 0; slot < node.n; ++slot) {
      const Item& item = opening_.child(slot);
      node.item[slot] = item.subtree.node;
      if (item.is_closed()) {
        node.child[slot] = leaf_word(item);
      } else if (item.subtree.size() <= cut_at_) {
        node.child[slot] = CollapsedPart::kCut | static_cast<layout::u32>(out_.cuts.size());
        out_.cuts.push_back(item.subtree);
      } else {
        node.child[slot] = static_cast<layout::u32>(first + n_inner);
        inner[n_inner++] = item.subtree;
      }
    }
    if (first + n_inner > KDRAY_WIDE_FIRST_MASK)
      throw Error(ErrorCode::input, "the kd-tree has over 2^29 wide nodes");
    out_.nodes.resize(first + n_inner);
    out_.nodes[index] = node;
    for (std::uint32_t i = 0; i < n_inner; ++i) fill(first + i, inner[i]);
  }

  layout::u32 leaf_word(const Item& item) {
    std::size_t& n = out_.n_blocks[item.kind];
    const auto first = static_cast<layout::u32>(n);
    const std::uint32_t leaf = item.subtree.node;
    const std::uint32_t n_refs =
        only_kind_ != kAnyKind ? tree_.nodes[leaf].right : leaf_run(tree_, leaf, item.kind).n;
    n += (n_refs + block_ - 1) / block_;
    if (n > KDRAY_WIDE_FIRST_MASK) throw Error(ErrorCode::input, "the kd-tree has over 2^29 leaf blocks");
    return KDRAY_WIDE_LEAF | item.kind << KDRAY_WIDE_KIND_SHIFT | first;
  }

  const kdtree::Tree& tree_;
  const std::uint32_t block_, only_kind_, cut_at_;
  Opening opening_;
  CollapsedPart& out_;
};

}  // namespace

LeafRun leaf_run(const kdtree::Tree& tree, std::uint32_t leaf, std::uint32_t kind) {
  const kdtree::Node& node = tree.nodes[leaf];
  std::uint32_t first = node.left, end = node.left + node.right;
  const auto kind_at = [&](std::uint32_t i) {
    return static_cast<std::uint32_t>(kdtree::ref_kind(tree.refs[i]));
  };
  while (first < end && kind_at(first) < kind) ++first;
  while (first < end && kind_at(end - 1) > kind) --end;
  return {first, end - first};
}

CollapsedPart collapse(const kdtree::Tree& tree, const Subtree& root, std::uint32_t block,
                       std::uint32_t only_kind, std::uint32_t cut_at) {
  CollapsedPart part;
  Collapse(tree, block, only_kind, cut_at, part).run(root);
  return part;
}

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
    for (std::size_t octant = 0; octant < 8; ++octant) {
      needs[i][octant] = static_cast<std::uint16_t>(node.n);
      // Each is popped with those behind it left.
      layout::u32 order = node.order[octant] >> (3 * (kWidth - node.n));
      for (std::uint32_t behind = 0; behind < node.n; ++behind, order >>= 3) {
        const auto need = static_cast<std::uint16_t>(behind + (*below[order & 7u])[octant]);
        needs[i][octant] = std::max(needs[i][octant], need);
      }
    }
  }
  return needs.front();
}

}  // namespace kdray::flatten
