// Whole trees: well formed, complete, the same for any number of threads.
#include "accel/kdtree/build.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "accel/kdtree/check_tree.h"
#include "accel/kdtree/exact/exact.h"
#include "accel/kdtree/statistics.h"
#include "kdray/error.h"

namespace kdray::test {
namespace {

using kdtree::BuildConfig;
using kdtree::Quality;
using kdtree::Tree;

int default_depth(std::size_t n) {
  return static_cast<int>(8 + 1.3 * std::log2(static_cast<double>(n)));
}

constexpr Quality kQualities[] = {Quality::fast, Quality::balanced, Quality::best};

// Checks the trees of all builders.
void check_tree(const scene::Geometry& g, BuildConfig config = {}) {
  for (const Quality quality : kQualities)
    for (const bool groups : {false, true}) {
      SCOPED_TRACE(testing::Message()
                   << "quality " << static_cast<int>(quality) << (groups ? ", groups" : ""));
      config.quality = quality;
      config.groups = groups;
      const Tree tree = kdtree::build(g, config);
      check_shape(tree, g, config.max_depth >= 0 ? config.max_depth : default_depth(g.size()));
      if (!testing::Test::HasFatalFailure()) check_complete(tree, g, 12, 99);
    }
}

TEST(Build, EmptyGeometryIsOneEmptyLeaf) {
  const Tree tree = kdtree::build({});
  ASSERT_EQ(tree.nodes.size(), 1u);
  EXPECT_TRUE(tree.nodes[0].is_leaf());
  EXPECT_EQ(tree.nodes[0].right, 0u);
  EXPECT_TRUE(tree.refs.empty());
  EXPECT_TRUE(tree.bounds.empty());
}

TEST(Build, OnePrimitiveOfEachKind) {
  Random random(10);
  primitives::for_each_kind([&](auto kind) {
    SCOPED_TRACE(kind.kName);
    scene::Geometry g;
    add_primitives(kind, g, random, 1, 1);
    check_tree(g);
  });
}

TEST(Build, RandomPrimitives) {
  for (const float size : {0.1f, 1.0f, 6.0f}) {
    SCOPED_TRACE(size);
    Random random(11);
    check_tree(mixed_geometry(random, 1500, size));
  }
}

TEST(Build, ManySmallScenes) {
  Random random(12);
  for (int trial = 0; trial < 300 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    check_tree(mixed_geometry(random, 2 + trial % 30, trial % 2 == 0 ? 1.0f : 5.0f));
  }
}

TEST(Build, Architecture) {
  Random random(13);
  scene::Geometry g;
  add_architecture(g, random, 2000);
  check_tree(g);
}

// All geometry in one plane: the root itself is flat.
TEST(Build, FlatScene) {
  Random random(14);
  scene::Geometry g;
  add_triangles(g, random, 2000, 0.5f);
  for (auto& t : g.triangles) {
    for (auto& v : t.v) v[1] = 3;
  }
  check_tree(g);
}

TEST(Build, AFloorGetsAFlatCell) {
  scene::Geometry g;
  for (int i = 0; i < 40; ++i) {
    const vec3 c(i % 8, i / 8, 0);
    add_triangle(g, c, c + vec3(1, 0, 0), c + vec3(1, 1, 0));
    add_triangle(g, c, c + vec3(1, 1, 0), c + vec3(0, 1, 0));
  }
  add_triangle(g, {0, 0, 4}, {8, 0, 5}, {4, 5, 6});
  BuildConfig best;
  best.quality = Quality::best;
  best.tight_cells = false;
  const Tree tree = kdtree::build(g, best);
  // Somewhere a plane at z = 0 parts the floor from the air above it.
  bool found = false;
  for (const kdtree::Node& n : tree.nodes) found |= !n.is_leaf() && n.axis == 2 && n.split == 0;
  EXPECT_TRUE(found);
  check_tree(g);
}

TEST(Build, BoxedIsValidAndHasMoreReferences) {
  Random random(15);
  const scene::Geometry g = mixed_geometry(random, 2000, 1.5f);
  BuildConfig boxed;
  boxed.clip = false;
  check_tree(g, boxed);
  const auto clipped_cost = kdtree::measure(kdtree::build(g), g).sah_cost;
  const auto boxed_cost = kdtree::measure(kdtree::build(g, boxed), g, boxed).sah_cost;
  EXPECT_LT(clipped_cost, boxed_cost);
}

TEST(Build, DepthIsRespected) {
  Random random(16);
  const scene::Geometry g = mixed_geometry(random, 500, 0.5f);
  for (const int depth : {0, 1, 5, 12}) {
    SCOPED_TRACE(depth);
    BuildConfig config;
    config.max_depth = depth;
    check_tree(g, config);
    EXPECT_EQ(kdtree::build(g, config).max_depth, depth);
  }
  BuildConfig deep;
  deep.max_depth = 1000;  // the traversal's stack is the limit
  EXPECT_LE(kdtree::build(g, deep).max_depth, 64);
}

TEST(Build, OtherCosts) {
  Random random(17);
  const scene::Geometry g = mixed_geometry(random, 800, 0.7f);
  BuildConfig dear, cheap;
  dear.cost_traverse = 20;
  cheap.cost_traverse = 0;
  cheap.empty_bonus = 1;
  check_tree(g, dear);
  check_tree(g, cheap);
  EXPECT_LT(kdtree::build(g, dear).nodes.size(), kdtree::build(g, cheap).nodes.size());
}

TEST(Build, SenselessCostsAreRefused) {
  for (const double bad : {0.0, -1.0, double{NAN}, double{INFINITY}}) {
    BuildConfig config;
    config.cost_intersect = bad;
    EXPECT_THROW(kdtree::build({}, config), Error);
    config = {};
    config.empty_bonus = bad;
    EXPECT_THROW(kdtree::build({}, config), Error);
  }
}

TEST(Build, SenselessBlocksAreRefused) {
  for (const int bad : {-8, 0, 3, 128}) {
    BuildConfig config;
    config.block = bad;
    try {
      kdtree::build({}, config);
      ADD_FAILURE() << "blocks of " << bad;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::usage);
    }
  }
}

// Blocks and tight cells move planes, never what a leaf must hold: the checks are those of any tree. More
// references than one thread builds, so that the top is in it too.
TEST(Build, BlocksAndTightCells) {
  Random random(19);
  std::vector<scene::Geometry> geometries{
      mixed_geometry(random, 4000, 0.4f), mixed_geometry(random, 400, 6), {}, {}};
  add_architecture(geometries[2], random, 1500);
  for (int i = 0; i < 1000; ++i)
    add_triangle(geometries[3], {0, 0, 0}, random_vec3(random, -1, 1), random_vec3(random, -1, 1));
  for (const scene::Geometry& g : geometries)
    for (const int block : {1, 4, 8, 64})
      for (const bool tight : {false, true}) {
        SCOPED_TRACE(testing::Message()
                     << g.size() << " primitives, blocks of " << block << (tight ? ", tight" : ""));
        BuildConfig config;
        config.block = block;
        config.tight_cells = tight;
        check_tree(g, config);
        if (testing::Test::HasFailure()) return;
      }
}

TEST(Build, LargerBlocksTakeFewerReferences) {
  Random random(20);
  const scene::Geometry g = mixed_geometry(random, 3000, 1);
  std::size_t last = std::numeric_limits<std::size_t>::max();
  for (const int block : {1, 4, 8, 64}) {
    BuildConfig config;
    config.block = block;
    const std::size_t n = kdtree::build(g, config).refs.size();
    EXPECT_LT(n, last) << block;
    last = n;
  }
}

TEST(Build, TightCellsAreTheirContents) {
  const std::vector<kdtree::BoundedRef> refs{{{1, 2, 3}, 0, {2, 3, 4}}, {{0, 5, 3}, 1, {1, 6, 3}}};
  const kdtree::CellState state{{{-9, -9, -9}, {9, 9, 9}}, 3, 20};
  BuildConfig config;
  config.tight_cells = false;
  EXPECT_EQ(kdtree::tightened(state, refs, config).cell.lo, state.cell.lo);
  config.tight_cells = true;
  const kdtree::CellState tight = kdtree::tightened(state, refs, config);
  EXPECT_EQ(tight.cell.lo, (std::array<float, 3>{0, 2, 3}));
  EXPECT_EQ(tight.cell.hi, (std::array<float, 3>{2, 6, 4}));
  EXPECT_EQ(tight.depth, state.depth);
  EXPECT_EQ(tight.budget, state.budget);
  EXPECT_EQ(kdtree::tightened(state, {}, config).cell.hi, state.cell.hi);
}

TEST(Build, ThreadsDoNotShow) {
  Random random(18);
  scene::Geometry g;
  add_triangles(g, random, 40000, 0.3f);
  primitives::for_each_shape([&](auto kind) { add_primitives(kind, g, random, 2000, 0.3f); });
  for (const Quality quality : kQualities) {
    SCOPED_TRACE(testing::Message() << "quality " << static_cast<int>(quality));
    BuildConfig config;
    config.quality = quality;
    config.groups = quality != Quality::fast;
    std::vector<Tree> trees;
    for (const std::size_t threads : {1, 2, 5}) {
      tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      trees.push_back(kdtree::build(g, config));
    }
    for (const Tree& t : trees) {
      ASSERT_EQ(t.nodes.size(), trees[0].nodes.size());
      ASSERT_EQ(t.refs, trees[0].refs);
      ASSERT_EQ(std::memcmp(t.contents.data(), trees[0].contents.data(), t.contents.size() * sizeof(Box)), 0);
      EXPECT_EQ(std::memcmp(t.nodes.data(), trees[0].nodes.data(), t.nodes.size() * sizeof(kdtree::Node)), 0);
    }
    check_shape(trees[0], g, default_depth(g.size()));
    if (!HasFatalFailure()) check_complete(trees[0], g, 6, 5);
  }
}

}  // namespace
}  // namespace kdray::test
