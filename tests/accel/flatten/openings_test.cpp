// Which nodes are opened, against trying all ways: no wide form over the same binary tree is expected to have
// fewer of its nodes visited.
#include "accel/flatten/openings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <vector>

#include "accel/flatten/flat_of.h"
#include "accel/flatten/wide.h"
#include "accel/kdtree/build.h"
#include "accel/kdtree/shapes.h"

namespace kdray::flatten {
namespace {

using test::Random;

constexpr std::uint64_t kSeed = 93;

double area_of(const Box& b) {
  return b.empty() ? 0 : static_cast<double>(b.area());
}

// Tries all ways to choose up to eight children of each wide node.
class AllWays {
 public:
  explicit AllWays(const kdtree::Tree& tree) : tree_(tree) {}

  // The least sum of surfaces of the wide nodes of a subtree whose root is one.
  double least(std::uint32_t node) {
    const auto known = least_.find(node);
    if (known != least_.end()) return known->second;
    const double below = cheapest(ways_inside(node));
    return least_[node] = area_of(tree_.contents[node]) + below;
  }

 private:
  // Children of one wide node: how many, and what the wide nodes among them cost.
  struct Way {
    std::uint32_t n = 0;
    double cost = 0;
  };

  static double cheapest(const std::vector<Way>& ways) {
    double least = std::numeric_limits<double>::infinity();
    for (const Way& w : ways)
      if (w.n <= kWidth) least = std::min(least, w.cost);
    return least;
  }

  // The node itself as a child, or what is inside of it.
  std::vector<Way> ways(std::uint32_t node) {
    if (tree_.contents[node].empty()) return {{0, 0}};
    std::vector<Way> all = ways_inside(node);
    if (!is_one_child(node)) all.push_back({1, least(node)});
    return all;
  }

  bool is_one_child(std::uint32_t node) const {
    return tree_.nodes[node].is_leaf() && n_kinds(tree_, node) <= 1;
  }

  std::vector<Way> ways_inside(std::uint32_t node) {
    const kdtree::Node& split = tree_.nodes[node];
    if (split.is_leaf()) return {{n_kinds(tree_, node), 0}};
    std::vector<Way> all;
    for (const Way& below : ways(split.left))
      for (const Way& above : ways(split.right))
        if (below.n + above.n <= kWidth) all.push_back({below.n + above.n, below.cost + above.cost});
    return all;
  }

  const kdtree::Tree& tree_;
  std::map<std::uint32_t, double> least_;
};

// The sum of surfaces of the form's nodes, as their parents have them.
double surface_of(const WideForm& wide, const kdtree::Tree& tree) {
  double sum = area_of(tree.contents[0]);
  for (const layout::WideNode& node : wide.nodes)
    for (int slot = 0; slot < 8; ++slot) {
      Box b;
      for (int axis = 0; axis < 3; ++axis) {
        b.lo[axis] = node.bounds[axis][0][slot];
        b.hi[axis] = node.bounds[axis][1][slot];
      }
      if (!b.empty() && !(node.child[slot] & KDRAY_WIDE_LEAF)) sum += area_of(b);
    }
  return sum;
}

void expect_least(const scene::Geometry& g, const kdtree::BuildConfig& config) {
  const kdtree::Tree tree = kdtree::build(g, config);
  const WideForm wide = make_wide(tree, flat_of(g, tree), 4);
  const double least = AllWays(tree).least(0);
  EXPECT_NEAR(surface_of(wide, tree), least, 1e-5 * least) << tree.nodes.size() << " binary nodes";
}

// The trees are so small that all ways can be tried, which grow as 2 to the number of leaves.
TEST(Openings, NoOtherWayIsCheaper) {
  Random random(kSeed);
  std::size_t n_deep = 0;
  for (int i = 0; i < 60; ++i) {
    scene::Geometry g;
    test::add_triangles(g, random, 4 + i % 15, 0.4f);
    expect_least(g, {});
    n_deep += kdtree::build(g).nodes.size() > 2 * kWidth ? 1 : 0;
  }
  EXPECT_GT(n_deep, 20u) << "too few trees of more than one wide node";
}

TEST(Openings, NorWithSeveralKindsInALeaf) {
  Random random(kSeed);
  for (int i = 0; i < 40; ++i) {
    kdtree::BuildConfig config;
    config.block = 2;
    expect_least(test::mixed_geometry(random, 3 + i % 4, 0.5f), config);
  }
}

TEST(Openings, NorWithEmptyCells) {
  Random random(kSeed);
  kdtree::BuildConfig config;
  config.quality = kdtree::Quality::best;
  config.tight_cells = false;
  for (int i = 0; i < 30; ++i) {
    scene::Geometry g;
    test::add_primitives(primitives::SphereKind(), g, random, 3 + i % 4, 0.2f);
    expect_least(g, config);
  }
}

// Every inner node opens into eight slots, and each side gets one at least, whatever the surfaces are: none
// at all in one point, endless where they overflow.
void expect_sound(const kdtree::Tree& tree) {
  const Openings openings(tree, kAnyKind);
  for (std::uint32_t i = 0; i < tree.nodes.size(); ++i) {
    const kdtree::Node& node = tree.nodes[i];
    if (node.is_leaf() || tree.contents[node.left].empty() || tree.contents[node.right].empty()) continue;
    EXPECT_EQ(openings.share_below(i, 1), 0u);
    EXPECT_GE(openings.share_below(i, kWidth), 1u);
    for (std::uint32_t n = 2; n <= kWidth; ++n) EXPECT_LT(openings.share_below(i, n), n);
  }
}

// A chain of leaves, each with one triangle in the box.
kdtree::Tree chain(std::uint32_t n_leaves, const Box& contents) {
  kdtree::Tree tree;
  for (std::uint32_t i = 0; i < n_leaves; ++i) {
    const auto here = static_cast<std::uint32_t>(tree.nodes.size());
    if (i + 1 < n_leaves) {
      tree.nodes.push_back({0, 0, here + 1, here + 2});
      tree.contents.push_back(contents);
    }
    tree.nodes.push_back({kdtree::Node::kLeaf, 0, i, 1});
    tree.contents.push_back(contents);
    tree.refs.push_back(kdtree::make_ref(scene::PrimitiveKind::triangle, i));
  }
  tree.bounds = contents;
  return tree;
}

TEST(Openings, SurfacesOfNothingAndWithoutEnd) {
  Box point, endless;
  point.lo = point.hi = vec3(1);
  endless.lo = vec3(-3e38f);
  endless.hi = vec3(3e38f);
  expect_sound(chain(40, point));
  expect_sound(chain(40, endless));
}

}  // namespace
}  // namespace kdray::flatten
