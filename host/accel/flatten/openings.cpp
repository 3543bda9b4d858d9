#include "accel/flatten/openings.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <limits>

namespace kdray::flatten {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// What the wide nodes below a subtree are expected to cost where it may fill 1, 2, ... slots of one.
using Costs = std::array<float, kWidth>;

class Solver {
 public:
  Solver(const kdtree::Tree& tree, std::uint32_t only_kind, RawVector<std::uint32_t>& shares)
      : tree_(tree), only_kind_(only_kind), shares_(shares) {}

  // Returns the costs of the subtree of the nodes [node, end).
  Costs solve(std::uint32_t node, std::uint32_t end) {
    const kdtree::Node& split = tree_.nodes[node];
    if (split.is_leaf()) return of_leaf(node);
    if (tree_.contents[split.left].empty()) return solve(split.right, end);
    if (tree_.contents[split.right].empty()) return solve(split.left, split.right);
    Costs below, above;
    // Most nodes are just above leaves, and need no sums.
    if (is_free(split.left)) return of_free_and(node, solve(split.right, end));
    if (is_free(split.right)) return of_and_free(node, solve(split.left, split.right));
    if (end - node < kTask) {
      below = solve(split.left, split.right);
      above = solve(split.right, end);
    } else {
      tbb::parallel_invoke([&] { below = solve(split.left, split.right); },
                           [&] { above = solve(split.right, end); });
    }
    return of_two(node, below, above);
  }

 private:
  static constexpr std::uint32_t kTask = 1u << 13;  // nodes that are worth a thread

  Costs of_leaf(std::uint32_t leaf) const {
    Costs costs{};
    const std::uint32_t kinds = only_kind_ == kAnyKind ? n_kinds(tree_, leaf) : 1;
    for (std::uint32_t slots = 1; slots < kinds; ++slots) costs[slots - 1] = tree_.contents[leaf].area();
    return costs;
  }

  // Returns whether the node is a child as it is, in any number of slots, and costs nothing.
  bool is_free(std::uint32_t node) const {
    return tree_.nodes[node].is_leaf() && (only_kind_ != kAnyKind || n_kinds(tree_, node) <= 1);
  }

  // Returns the costs where the lower side is a leaf, which takes one slot, and the other side has the rest.
  Costs of_free_and(std::uint32_t node, const Costs& above) {
    std::array<float, kWidth> opened;
    opened[0] = kInfinity;
    std::copy_n(above.begin(), kWidth - 1, opened.begin() + 1);
    std::array<std::uint32_t, kWidth> share;
    share.fill(1);
    return closed_or(node, opened, share);
  }

  // Does the same where the upper side is a leaf: it gets the slots that don't lower the cost of the other
  // side.
  Costs of_and_free(std::uint32_t node, const Costs& below) {
    std::array<float, kWidth> opened;
    std::array<std::uint32_t, kWidth> share;
    opened[0] = kInfinity;
    share[0] = 1;
    for (std::uint32_t k = 1; k < kWidth; ++k) {
      const bool more = below[k - 1] < opened[k - 1];
      opened[k] = more ? below[k - 1] : opened[k - 1];
      share[k] = more ? k : share[k - 1];
    }
    return closed_or(node, opened, share);
  }

  Costs of_two(std::uint32_t node, const Costs& below, const Costs& above) {
    std::array<float, 2 * kWidth> shifted;  // those of `above`, behind as many that can't be
    shifted.fill(kInfinity);
    std::copy(above.begin(), above.end(), shifted.begin() + kWidth);
    Costs opened;
    opened.fill(kInfinity);
    std::array<std::uint32_t, kWidth> share;
    share.fill(1);
    for (std::uint32_t i = 1; i < kWidth; ++i)
      for (std::uint32_t k = 0; k < kWidth; ++k) {
        const float cost = below[i - 1] + shifted[kWidth + k - i];
        share[k] = cost < opened[k] ? i : share[k];
        opened[k] = std::min(opened[k], cost);
      }
    return closed_or(node, opened, share);
  }

  // A node that may fill more than one slot is opened where that costs no more.
  Costs closed_or(std::uint32_t node, const std::array<float, kWidth>& opened,
                  const std::array<std::uint32_t, kWidth>& share) {
    const float closed = tree_.contents[node].area() + opened[kWidth - 1];
    Costs costs;
    costs[0] = closed;
    std::uint32_t word = 0;
    for (std::uint32_t k = 1; k < kWidth; ++k) {
      word |= (closed < opened[k] ? 0 : share[k]) << (3 * k);
      costs[k] = std::min(closed, opened[k]);
    }
    shares_[node] = word;
    return costs;
  }

  const kdtree::Tree& tree_;
  const std::uint32_t only_kind_;
  RawVector<std::uint32_t>& shares_;
};

}  // namespace

Openings::Openings(const kdtree::Tree& tree, std::uint32_t only_kind) : shares_(tree.nodes.size()) {
  Solver(tree, only_kind, shares_).solve(0, static_cast<std::uint32_t>(tree.nodes.size()));
}

std::uint32_t n_kinds(const kdtree::Tree& tree, std::uint32_t leaf) {
  const kdtree::Node& node = tree.nodes[leaf];
  std::uint32_t n = 0;
  for (std::uint32_t i = 0; i < node.right; ++i) {
    const kdtree::Ref ref = tree.refs[node.left + i];
    n += i == 0 || kdtree::ref_kind(ref) != kdtree::ref_kind(tree.refs[node.left + i - 1]) ? 1 : 0;
  }
  return n;
}

}  // namespace kdray::flatten
