#include "accel/kdtree/fragment.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "accel/kdtree/binned/binned.h"

namespace kdray::kdtree {

void Fragment::clear() {
  nodes.clear();
  refs.clear();
  contents.clear();
  max_depth = 0;
}

std::span<Ref> add_leaf(std::size_t n, const Bounds& contents, int depth, Fragment& out) {
  const std::size_t first = out.refs.size();
  out.refs.resize(first + n);
  out.contents.push_back(box_from(contents));
  out.nodes.push_back({Node::kLeaf, 0, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(n)});
  out.max_depth = std::max(out.max_depth, depth);
  return std::span(out.refs).subspan(first);
}

void write_sorted(std::span<const BoundedRef> refs, std::span<Ref> out) {
  std::transform(refs.begin(), refs.end(), out.begin(), [](const BoundedRef& r) { return r.ref; });
  std::sort(out.begin(), out.end());
}

Box append_cell(std::span<BoundedRef> refs, const Bounds& contents, int depth, const BuildConfig& config,
                Fragment& out) {
  if (config.groups) {
    binned::append_groups(refs, contents, depth, config, out);
  } else {
    write_sorted(refs, add_leaf(refs.size(), contents, depth, out));
  }
  return box_from(contents);
}

namespace {

// A fragment and where it goes.
struct Placed {
  TopNode* top;
  std::size_t first_node, first_ref;
};

class Assembler {
 public:
  explicit Assembler(Tree& tree) : tree_(tree) {}

  void run(TopNode& top) {
    layout(top);
    tree_.nodes.resize(n_nodes_);
    tree_.contents.resize(n_nodes_);
    tree_.refs.resize(n_refs_);
    tbb::parallel_for(std::size_t{0}, placed_.size(), [&](std::size_t i) { place(placed_[i]); });
    link(top);
  }

 private:
  // Gives each fragment its place, in preorder.
  void layout(TopNode& top) {
    if (!top.is_fragment()) {
      ++n_nodes_;
      layout(*top.below);
      return layout(*top.above);
    }
    placed_.push_back({&top, n_nodes_, n_refs_});
    n_nodes_ += top.fragment.nodes.size();
    n_refs_ += top.fragment.refs.size();
    tree_.max_depth = std::max(tree_.max_depth, top.fragment.max_depth);
  }

  // Copies a fragment and makes its indices the tree's.
  void place(const Placed& p) const {
    Fragment& fragment = p.top->fragment;
    for (std::size_t i = 0; i < fragment.nodes.size(); ++i) {
      Node node = fragment.nodes[i];
      node.left += static_cast<std::uint32_t>(node.is_leaf() ? p.first_ref : p.first_node);
      if (!node.is_leaf()) node.right += static_cast<std::uint32_t>(p.first_node);
      tree_.nodes[p.first_node + i] = node;
    }
    std::copy(fragment.refs.begin(), fragment.refs.end(),
              tree_.refs.begin() + static_cast<std::ptrdiff_t>(p.first_ref));
    std::copy(fragment.contents.begin(), fragment.contents.end(),
              tree_.contents.begin() + static_cast<std::ptrdiff_t>(p.first_node));
    fragment = {};
  }

  // Writes the top's inner nodes, and their contents from below; returns the node's index.
  std::size_t link(const TopNode& top) {
    if (top.is_fragment()) return placed_[next_++].first_node;
    const std::size_t below = link(*top.below), above = link(*top.above), self = below - 1;
    tree_.nodes[self] = {static_cast<std::uint32_t>(top.axis), top.position,
                         static_cast<std::uint32_t>(below), static_cast<std::uint32_t>(above)};
    tree_.contents[self] = tree_.contents[below];
    tree_.contents[self].grow(tree_.contents[above]);
    return self;
  }

  Tree& tree_;
  std::vector<Placed> placed_;
  std::size_t n_nodes_ = 0, n_refs_ = 0, next_ = 0;
};

}  // namespace

Tree assemble(TopNode& top) {
  Tree tree;
  Assembler(tree).run(top);
  return tree;
}

}  // namespace kdray::kdtree
