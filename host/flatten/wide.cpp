#include "flatten/wide.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace kdray::flatten {

namespace {

constexpr int kWidth = 8;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A child to be: a subtree of the binary tree, or, of a leaf, only its references of one kind.
struct Item {
  static constexpr int kWhole = -1;
  std::uint32_t node = 0;
  int kind = kWhole;
  bool operator==(const Item&) const = default;
};

// References of one kind in a leaf, and where their blocks begin.
struct Run {
  std::uint32_t first_ref, n_refs;
  layout::u32 first_block;
  int kind;
};

struct Items {
  std::array<Item, kWidth> item;
  int n = 0;
  void add(const Item& i) { item[static_cast<std::size_t>(n++)] = i; }
  Item& operator[](int i) { return item[static_cast<std::size_t>(i)]; }
  const Item& operator[](int i) const { return item[static_cast<std::size_t>(i)]; }
};

// Entries on the stack, for rays of each octant.
using Needs = std::array<int, 8>;

class Collapse {
 public:
  Collapse(const kdtree::Tree& tree, int block, WideForm& out)
      : tree_(tree), block_(static_cast<std::uint32_t>(block)), out_(out) {}

  void run() {
    out_.nodes.reserve(tree_.nodes.size() / 8 + 1);
    out_.nodes.emplace_back();
    Items root;
    if (!is_empty({0})) root.add({0});
    const Needs needs = fill(0, {0}, root);
    out_.stack_size = *std::max_element(needs.begin(), needs.end());
  }

  const std::vector<Run>& runs() const { return runs_; }
  std::size_t n_blocks(int kind) const { return n_blocks_[static_cast<std::size_t>(kind)]; }

 private:
  bool is_empty(const Item& i) const { return tree_.contents[i.node].empty(); }

  // The leaf's references of one kind; within a leaf references ascend, so kinds follow each other.
  Run run_of(std::uint32_t leaf, int kind) const {
    const kdtree::Node& node = tree_.nodes[leaf];
    std::uint32_t first = node.left, end = node.left + node.right;
    const auto kind_at = [&](std::uint32_t i) { return static_cast<int>(kdtree::ref_kind(tree_.refs[i])); };
    while (first < end && kind_at(first) < kind) ++first;
    std::uint32_t last = first;
    while (last < end && kind_at(last) == kind) ++last;
    return {first, last - first, 0, kind};
  }

  // What an item is made of; itself when it is a leaf of one kind.
  Items opened(const Item& i) const {
    Items parts;
    const kdtree::Node& node = tree_.nodes[i.node];
    if (i.kind != Item::kWhole) {
      parts.add(i);
    } else if (node.is_leaf()) {
      for (int kind = 0; kind < 3; ++kind)
        if (run_of(i.node, kind).n_refs > 0) parts.add({i.node, kind});
    } else {
      for (const std::uint32_t child : {node.left, node.right})
        if (!is_empty({child})) parts.add({child});
    }
    return parts;
  }

  bool is_closed(const Item& i) const { return i.kind != Item::kWhole; }

  // Opens the largest items until the node is full or all are leaves.
  void open_largest(Items& items) const {
    for (;;) {
      int best = -1;
      float best_area = -1;
      for (int i = 0; i < items.n; ++i) {
        if (is_closed(items[i])) continue;
        const Items parts = opened(items[i]);
        if (items.n - 1 + parts.n > kWidth) continue;
        const float area = parts.n == 1 ? kInfinity : tree_.contents[items[i].node].area();
        if (area > best_area) {
          best = i;
          best_area = area;
        }
      }
      if (best < 0) return;
      const Items parts = opened(items[best]);
      items[best] = parts[0];
      for (int i = 1; i < parts.n; ++i) items.add(parts[i]);
    }
  }

  // Appends the slots of the items below `i`, near to far for directions of the octant.
  void order_below(const Item& i, const Items& items, unsigned octant, std::vector<unsigned>& out) const {
    for (int k = 0; k < items.n; ++k)
      if (items[k] == i) return out.push_back(static_cast<unsigned>(k));
    const kdtree::Node& node = tree_.nodes[i.node];
    Items parts = opened(i);
    if (!node.is_leaf() && parts.n == 2 && (octant >> node.axis & 1u)) std::swap(parts[0], parts[1]);
    for (int k = 0; k < parts.n; ++k) order_below(parts[k], items, octant, out);
  }

  std::vector<unsigned> near_to_far(const Item& root, const Items& items, unsigned octant) const {
    std::vector<unsigned> slots;
    slots.reserve(kWidth);
    order_below(root, items, octant, slots);
    return slots;
  }

  static layout::u32 order_word(std::vector<unsigned> near_to_far) {
    for (auto k = static_cast<unsigned>(near_to_far.size()); k < kWidth; ++k) near_to_far.push_back(k);
    layout::u32 word = 0;
    for (unsigned k = 0; k < kWidth; ++k) word |= near_to_far[kWidth - 1 - k] << (3 * k);
    return word;
  }

  void set_bounds(layout::WideNode& node, const Items& items) const {
    for (int slot = 0; slot < kWidth; ++slot) {
      const Box box = slot < items.n ? tree_.contents[items[slot].node] : Box();
      for (int axis = 0; axis < 3; ++axis) {
        node.bounds[axis][0][slot] = box.lo[axis];
        node.bounds[axis][1][slot] = box.hi[axis];
      }
    }
  }

  layout::u32 leaf_word(const Item& i) {
    Run run = run_of(i.node, i.kind);
    std::size_t& n = n_blocks_[static_cast<std::size_t>(i.kind)];
    run.first_block = static_cast<layout::u32>(n);
    n += (run.n_refs + block_ - 1) / block_;
    if (n > KDRAY_WIDE_FIRST_MASK) throw Error(ErrorCode::input, "the kd-tree has over 2^29 leaf blocks");
    runs_.push_back(run);
    return KDRAY_WIDE_LEAF | static_cast<layout::u32>(i.kind) << KDRAY_WIDE_KIND_SHIFT | run.first_block;
  }

  // Writes the node whose children are found below `items`, then its subtree. Returns the stack that the subtree needs, for
  // rays of each octant: all children are pushed, then each is popped with those behind it left below.
  Needs fill(std::size_t index, const Item& root, Items items) {
    open_largest(items);
    layout::WideNode node{};
    set_bounds(node, items);
    std::array<std::vector<unsigned>, 8> order;
    for (unsigned octant = 0; octant < 8; ++octant) {
      order[octant] = near_to_far(root, items, octant);
      node.order[octant] = order_word(order[octant]);
    }
    const std::size_t first_child = out_.nodes.size();
    std::size_t n_inner = 0;
    for (int slot = 0; slot < items.n; ++slot)
      node.child[slot] =
          is_closed(items[slot]) ? leaf_word(items[slot]) : static_cast<layout::u32>(first_child + n_inner++);
    if (first_child + n_inner > KDRAY_WIDE_FIRST_MASK)
      throw Error(ErrorCode::input, "the kd-tree has over 2^29 wide nodes");
    out_.nodes.resize(first_child + n_inner);
    out_.nodes[index] = node;
    Needs needs;
    needs.fill(items.n);
    for (int slot = 0; slot < items.n; ++slot) {
      if (is_closed(items[slot])) continue;
      Items child;
      child.add(items[slot]);
      const Needs below = fill(node.child[slot], items[slot], child);
      for (std::size_t octant = 0; octant < 8; ++octant) {
        const auto nearer =
            std::find(order[octant].begin(), order[octant].end(), static_cast<unsigned>(slot));
        const int behind = static_cast<int>(order[octant].end() - nearer) - 1;
        needs[octant] = std::max(needs[octant], behind + below[octant]);
      }
    }
    return needs;
  }

  const kdtree::Tree& tree_;
  const std::uint32_t block_;
  WideForm& out_;
  std::vector<Run> runs_;
  std::array<std::size_t, 3> n_blocks_{};
};

layout::u32 bits(float v) {
  return std::bit_cast<layout::u32>(v);
}

// |n|_1 of the normal that the kernels compute in float, or more.
float normal_bound(const layout::Triangle& t) {
  double e[2][3];
  for (int k = 0; k < 3; ++k) {
    e[0][k] = static_cast<double>(t.v[1][k]) - t.v[0][k];
    e[1][k] = static_cast<double>(t.v[2][k]) - t.v[0][k];
  }
  double sum = 0, size = 0;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    sum += std::abs(e[0][i] * e[1][j] - e[0][j] * e[1][i]);
    size += std::abs(e[0][i] * e[1][j]) + std::abs(e[0][j] * e[1][i]);
  }
  // In float the edges are off by 2^-24 of themselves, a product by 2^-22; where products underflow, a component by 2^-149.
  return std::nextafter(static_cast<float>(sum * (1 + 1e-6) + size * 1e-6 + 0x1p-147), kInfinity);
}

// The rows of a primitive in its block, without the index.
std::array<float, KDRAY_TRIANGLE_ROWS - 1> rows_of(const layout::Triangle& t) {
  return {t.v[0][0], t.v[0][1], t.v[0][2], t.v[1][0], t.v[1][1],
          t.v[1][2], t.v[2][0], t.v[2][1], t.v[2][2], normal_bound(t)};
}
std::array<float, KDRAY_SPHERE_ROWS - 1> rows_of(const layout::Sphere& s) {
  return {s.center[0], s.center[1], s.center[2], s.radius};
}
std::array<float, KDRAY_CONE_ROWS - 1> rows_of(const layout::Cone& c) {
  return {c.base[0], c.base[1], c.base[2], c.axis[0], c.axis[1], c.axis[2], c.base_radius, c.height, c.slope};
}

template <class Primitive>
void fill_run(const Run& run, const kdtree::Tree& tree, const std::vector<Primitive>& primitives,
              std::uint32_t block, std::vector<layout::u32>& blocks) {
  constexpr std::size_t kRows = std::tuple_size_v<decltype(rows_of(Primitive()))>;
  const std::uint32_t n_lanes = (run.n_refs + block - 1) / block * block;
  for (std::uint32_t i = 0; i < n_lanes; ++i) {
    layout::u32* words = &blocks[(run.first_block + i / block) * (kRows + 1) * block] + i % block;
    const bool used = i < run.n_refs;
    const std::uint32_t index = used ? kdtree::ref_index(tree.refs[run.first_ref + i]) : 0;
    const auto rows = used ? rows_of(primitives[index]) : std::array<float, kRows>{};
    for (std::size_t r = 0; r < kRows; ++r) words[r * block] = used ? bits(rows[r]) : bits(NAN);
    words[kRows * block] = index | (i + 1 >= run.n_refs ? KDRAY_WIDE_LAST : 0);
  }
}

}  // namespace

std::size_t WideForm::bytes() const {
  return nodes.size() * sizeof(layout::WideNode) +
         (triangle_blocks.size() + sphere_blocks.size() + cone_blocks.size()) * sizeof(layout::u32);
}

WideForm make_wide(const kdtree::Tree& tree, const FlatScene& primitives, int block) {
  WideForm form;
  form.block = block;
  Collapse collapse(tree, block, form);
  collapse.run();
  const auto width = static_cast<std::uint32_t>(block);
  form.triangle_blocks.resize(collapse.n_blocks(0) * KDRAY_TRIANGLE_ROWS * width);
  form.sphere_blocks.resize(collapse.n_blocks(1) * KDRAY_SPHERE_ROWS * width);
  form.cone_blocks.resize(collapse.n_blocks(2) * KDRAY_CONE_ROWS * width);
  const std::vector<Run>& runs = collapse.runs();
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
    const Run& run = runs[i];
    if (run.kind == 0) fill_run(run, tree, primitives.triangles, width, form.triangle_blocks);
    if (run.kind == 1) fill_run(run, tree, primitives.spheres, width, form.sphere_blocks);
    if (run.kind == 2) fill_run(run, tree, primitives.cones, width, form.cone_blocks);
  });
  return form;
}

int choose_block(const kdtree::Tree& tree) {
  std::size_t lanes4 = 0, lanes8 = 0;
  for (const kdtree::Node& node : tree.nodes)
    if (node.is_leaf()) {
      lanes4 += (node.right + 3) / 4 * 4;
      lanes8 += (node.right + 7) / 8 * 8;
    }
  return 2 * lanes8 <= 3 * lanes4 ? 8 : 4;
}

}  // namespace kdray::flatten
