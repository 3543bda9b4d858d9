#include "accel/kdtree/check_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "accel/kdtree/reference.h"

namespace kdray::test {

namespace {

using kdtree::Bounds;
using kdtree::Node;
using kdtree::Ref;
using kdtree::ref_index;
using kdtree::ref_kind;
using kdtree::Tree;

class ShapeCheck {
 public:
  ShapeCheck(const Tree& tree, const scene::Geometry& geometry) : tree_(tree), geometry_(geometry) {}

  void run(int max_depth) {
    ASSERT_FALSE(tree_.nodes.empty());
    ASSERT_EQ(tree_.contents.size(), tree_.nodes.size());
    visit(0, kdtree::bounds_from(tree_.bounds), 0);
    EXPECT_EQ(n_visited_, tree_.nodes.size());
    EXPECT_EQ(next_ref_, tree_.refs.size());
    EXPECT_EQ(deepest_, tree_.max_depth);
    EXPECT_LE(tree_.max_depth, max_depth);
  }

 private:
  // Preorder without a gap: so children are found once, and cells of one node's children share a face only.
  void visit(std::uint32_t index, const Bounds& cell, int depth) {
    ASSERT_EQ(index, n_visited_);
    ASSERT_LT(index, tree_.nodes.size());
    ASSERT_LE(depth, 64);
    ++n_visited_;
    const Node& node = tree_.nodes[index];
    const Box& contents = tree_.contents[index];
    ASSERT_TRUE(kdtree::box_from(cell).contains(contents)) << "node " << index;
    if (node.is_leaf()) {
      ASSERT_EQ(contents.empty(), node.right == 0);
      deepest_ = std::max(deepest_, depth);
      return check_leaf(node);
    }
    if (node.has_groups()) return check_groups(index, cell, depth);
    ASSERT_LT(node.axis, 3u);
    ASSERT_LE(cell.lo[node.axis], node.split);
    ASSERT_GE(cell.hi[node.axis], node.split);
    ASSERT_LT(cell.lo[node.axis], cell.hi[node.axis]) << "a flat cell cut across its thickness";
    EXPECT_EQ(node.left, index + 1);
    const int axis = static_cast<int>(node.axis);
    ASSERT_LT(node.right, tree_.nodes.size());
    ASSERT_TRUE(contents.contains(tree_.contents[node.left]) &&
                contents.contains(tree_.contents[node.right]));
    visit(node.left, kdtree::below(cell, axis, node.split), depth + 1);
    if (testing::Test::HasFatalFailure()) return;
    visit(node.right, kdtree::above(cell, axis, node.split), depth + 1);
  }

  // Both sides are in the whole cell; each of its primitives is in one of the groups, and the first has the
  // smaller centres.
  void check_groups(std::uint32_t index, const Bounds& cell, int depth) {
    const Node node = tree_.nodes[index];
    ASSERT_LT(node.order_axis(), 3u);
    EXPECT_EQ(node.left, index + 1);
    ASSERT_LT(node.right, tree_.nodes.size());
    const kdtree::RefRun run = kdtree::refs_of_cell(tree_, index);
    ASSERT_LE(std::size_t{run.first} + run.n, tree_.refs.size());
    std::vector<Ref> refs(tree_.refs.begin() + run.first, tree_.refs.begin() + run.first + run.n);
    std::sort(refs.begin(), refs.end());
    ASSERT_EQ(std::adjacent_find(refs.begin(), refs.end()), refs.end()) << "a primitive in two groups";
    for (const std::uint32_t side : {node.left, node.right}) {
      ASSERT_TRUE(tree_.nodes[side].is_leaf() || tree_.nodes[side].has_groups()) << "a plane below groups";
      ASSERT_FALSE(tree_.contents[side].empty());
      ASSERT_TRUE(tree_.contents[index].contains(tree_.contents[side]));
      visit(side, cell, depth);
      if (testing::Test::HasFatalFailure()) return;
    }
  }

  void check_leaf(const Node& leaf) {
    ASSERT_EQ(leaf.left, next_ref_);
    next_ref_ += leaf.right;
    ASSERT_LE(next_ref_, tree_.refs.size());
    for (std::size_t i = leaf.left; i < next_ref_; ++i) {
      const Ref r = tree_.refs[i];
      if (i > leaf.left) {
        ASSERT_LT(tree_.refs[i - 1], r);
      }
      const auto kind = static_cast<std::uint32_t>(ref_kind(r));
      ASSERT_LT(kind, primitives::kKinds);
      ASSERT_LT(ref_index(r),
                primitives::with_kind(kind, [&](auto k) { return decltype(k)::of(geometry_).size(); }));
    }
  }

  const Tree& tree_;
  const scene::Geometry& geometry_;
  std::size_t n_visited_ = 0, next_ref_ = 0;
  int deepest_ = 0;
};

bool in_bounds(const Box& b, const dvec3& p, double tolerance) {
  return glm::all(glm::lessThanEqual(dvec3(b.lo) - tolerance, p)) &&
         glm::all(glm::lessThanEqual(p, dvec3(b.hi) + tolerance));
}

// Whether a leaf whose closed cell and contents, widened by `tolerance`, hold p refers to r.
bool leaf_refers(const Tree& tree, const dvec3& p, double tolerance, Ref r) {
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const Node& node = tree.nodes[stack.back()];
    const Box& contents = tree.contents[stack.back()];
    stack.pop_back();
    if (!in_bounds(contents, p, tolerance)) continue;
    if (node.is_leaf()) {
      const auto first = tree.refs.begin() + node.left;
      if (std::binary_search(first, first + node.right, r)) return true;
      continue;
    }
    if (node.has_groups()) {
      stack.push_back(node.left);
      stack.push_back(node.right);
      continue;
    }
    const double x = p[static_cast<int>(node.axis)];
    if (x - tolerance <= node.split) stack.push_back(node.left);
    if (x + tolerance >= node.split) stack.push_back(node.right);
  }
  return false;
}

// Vertices, points of edges and of the inside; exact, since coordinates and weights have few bits.
dvec3 triangle_point(const scene::TriangleGeometry& t, int sample, Random& random) {
  constexpr int kWhole = 1024;
  int i = static_cast<int>(random() % (kWhole + 1)), j = static_cast<int>(random() % (kWhole - i + 1));
  if (sample < 3) {
    i = sample == 0 ? kWhole : 0;
    j = sample == 1 ? kWhole : 0;
  } else if (sample < 6) {
    j = sample == 3 ? kWhole - i : (sample == 4 ? 0 : j);
    if (sample == 5) i = 0;
  }
  const dvec3 sum = dvec3(scene::vertex(t, 0)) * double(i) + dvec3(scene::vertex(t, 1)) * double(j) +
                    dvec3(scene::vertex(t, 2)) * double(kWhole - i - j);
  return sum / double(kWhole);
}

void expect_found(const Tree& tree, const dvec3& p, double tolerance, Ref r) {
  ASSERT_TRUE(in_bounds(tree.bounds, p, tolerance));
  ASSERT_TRUE(leaf_refers(tree, p, tolerance, r))
      << "kind " << static_cast<int>(ref_kind(r)) << " number " << ref_index(r) << " at " << p.x << ' ' << p.y
      << ' ' << p.z;
}

}  // namespace

void check_shape(const Tree& tree, const scene::Geometry& geometry, int max_depth) {
  ShapeCheck(tree, geometry).run(max_depth);
}

void check_complete(const Tree& tree, const scene::Geometry& geometry, int per_primitive,
                    std::uint64_t seed) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Random random(seed);
  Draw draw(seed);
  primitives::for_each_kind([&](auto kind) {
    using Kind = decltype(kind);
    SCOPED_TRACE(Kind::kName);
    const auto& all = Kind::of(geometry);
    for (std::uint32_t i = 0; i < all.size() && !testing::Test::HasFatalFailure(); ++i)
      for (int sample = 0; sample < per_primitive; ++sample) {
        const kdtree::Ref ref = kdtree::make_ref(Kind::kKind, i);
        // Points of shapes are off by some rounding of doubles of size 20.
        if constexpr (Kind::kIsShape)
          expect_found(tree, dvec3(Samples<Kind>::point(all[i], draw)), 1e-14, ref);
        else
          expect_found(tree, triangle_point(all[i], sample, random), 0, ref);
      }
  });
}

}  // namespace kdray::test
