// The wide form against the binary tree that it is made of: the same leaves below the same boxes, all of them
// in an order that is front to back, on a stack that is large enough; and the numbers in its blocks.
#include "accel/flatten/wide.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <tuple>

#include "accel/flatten/flat_of.h"
#include "accel/flatten/lanes.h"
#include "accel/kdtree/build.h"
#include "accel/kdtree/shapes.h"

namespace kdray::flatten {
namespace {

using layout::u32;
using layout::WideNode;
using test::Random;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::uint64_t kSeed = 71;

// ---- Scenes

// n triangles about one corner, which no plane parts there.
void add_fan(scene::Geometry& g, Random& random, int n) {
  for (int i = 0; i < n; ++i)
    test::add_triangle(g, vec3(0), test::random_vec3(random, -1, 1), test::random_vec3(random, -1, 1));
}

// Squares of one plane that cover each other, and each of them several times.
void add_layers(scene::Geometry& g) {
  for (int i = 0; i < 60; ++i) {
    const vec3 corner(i % 4, i % 5, 2);
    for (int copy = 0; copy < 3; ++copy)
      test::add_triangle(g, corner, corner + vec3(2, 0, 0), corner + vec3(0, 2, 0));
  }
}

struct NamedGeometry {
  std::string name;
  scene::Geometry geometry;
};

std::vector<NamedGeometry> geometries() {
  Random random(kSeed);
  std::vector<NamedGeometry> all;
  const auto add = [&all](std::string name) -> scene::Geometry& {
    return all.emplace_back(NamedGeometry{std::move(name), {}}).geometry;
  };
  add("empty");
  primitives::for_each_kind([&](auto kind) {
    test::add_primitives(kind, add(std::string("one ") + kind.kName), random, 1, 1);
    test::add_primitives(kind, add(kind.kNames), random, kind.kIsShape ? 800 : 1500, 0.6f);
  });
  add("mixed") = test::mixed_geometry(random, 800, 0.5f);
  add("large and mixed") = test::mixed_geometry(random, 200, 6);
  test::add_architecture(add("architecture"), random, 700);
  add_layers(add("layers"));
  add_fan(add("fan"), random, 3000);
  return all;
}

struct Subject {
  std::string name;
  kdtree::Tree tree;
  FlatScene flat;
  WideForm wide;
};

// The subjects are every scene, by every kind of tree, in blocks of 4 and of 8.
const std::vector<Subject>& subjects() {
  static const std::vector<Subject> all = [] {
    std::vector<Subject> made;
    for (const NamedGeometry& g : geometries())
      for (const int leaf_block : {1, 8})
        for (const bool loose : {false, true})
          for (const bool groups : {false, true}) {
            kdtree::BuildConfig config;
            config.block = leaf_block;
            config.quality = loose ? kdtree::Quality::best : kdtree::Quality::balanced;
            config.tight_cells = !loose;  // loose cells: some are empty, some flat
            config.groups = groups;
            const kdtree::Tree tree = kdtree::build(g.geometry, config);
            const FlatScene flat = flat_of(g.geometry, tree);
            for (const int block : {4, 8})
              made.push_back({g.name + ", leaves for blocks of " + std::to_string(leaf_block) +
                                  (loose ? ", loose" : "") + (groups ? ", groups" : "") + ", in blocks of " +
                                  std::to_string(block),
                              tree, flat, make_wide(tree, flat, block)});
          }
    return made;
  }();
  return all;
}

template <class Check>
void for_each_subject(Check check) {
  for (const Subject& s : subjects()) {
    SCOPED_TRACE(s.name);
    check(s);
    if (testing::Test::HasFailure()) return;
  }
}

// These are the trees without groups, whose bounds may overlap.
template <class Check>
void for_each_of_planes(Check check) {
  for_each_subject([&](const Subject& s) {
    const auto is_group = [](const kdtree::Node& node) { return node.has_groups(); };
    if (std::none_of(s.tree.nodes.begin(), s.tree.nodes.end(), is_group)) check(s);
  });
}

// ---- Reading the form

bool is_leaf(u32 child) {
  return child & KDRAY_WIDE_LEAF;
}
int kind_of(u32 leaf) {
  return static_cast<int>(leaf_kind(leaf));
}

Box bounds_of(const WideNode& node, int slot) {
  Box b;
  for (int axis = 0; axis < 3; ++axis) {
    b.lo[axis] = node.bounds[axis][0][slot];
    b.hi[axis] = node.bounds[axis][1][slot];
  }
  return b;
}

// A slot without child has bounds that no ray meets; children come first.
int n_children(const WideNode& node) {
  int n = 0;
  while (n < 8 && !bounds_of(node, n).empty()) ++n;
  return n;
}

// The n-th slot from near to far for the octant.
int nth_slot(const WideNode& node, unsigned octant, int n) {
  return static_cast<int>(node.order[octant] >> 3 * (7 - n) & 7u);
}

// The primitives of a leaf up to the first that says it is the last, as the kernels read it.
std::vector<u32> indices_of(const WideForm& wide, u32 leaf) {
  std::vector<u32> indices;
  const std::size_t first = std::size_t{leaf & KDRAY_WIDE_FIRST_MASK} * wide.block;
  const std::size_t n_lanes = blocks_of(wide, kind_of(leaf)).size() / kRows[kind_of(leaf)];
  for (std::size_t i = first; i < n_lanes; ++i) {
    const Lane lane(wide, kind_of(leaf), i);
    indices.push_back(lane.index());
    if (lane.is_last()) return indices;
  }
  ADD_FAILURE() << "a leaf without an end";
  return indices;
}

// ---- Leaves

using Corners = std::array<float, 6>;
using Leaf = std::tuple<int, Corners, std::vector<u32>>;  // kind, bounds, indices

Corners corners_of(const Box& b) {
  return {b.lo.x, b.lo.y, b.lo.z, b.hi.x, b.hi.y, b.hi.z};
}

std::vector<Leaf> leaves_of(const kdtree::Tree& tree) {
  std::vector<Leaf> leaves;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const kdtree::Node& node = tree.nodes[i];
    if (!node.is_leaf()) continue;
    std::vector<u32> indices[kKinds];
    for (u32 k = 0; k < node.right; ++k) {
      const kdtree::Ref r = tree.refs[node.left + k];
      indices[static_cast<int>(kdtree::ref_kind(r))].push_back(kdtree::ref_index(r));
    }
    for (int kind = 0; kind < kKinds; ++kind)
      if (!indices[kind].empty()) leaves.emplace_back(kind, corners_of(tree.contents[i]), indices[kind]);
  }
  std::sort(leaves.begin(), leaves.end());
  return leaves;
}

std::vector<Leaf> leaves_of(const WideForm& wide) {
  std::vector<Leaf> leaves;
  for (const WideNode& node : wide.nodes)
    for (int slot = 0; slot < n_children(node); ++slot)
      if (is_leaf(node.child[slot]))
        leaves.emplace_back(kind_of(node.child[slot]), corners_of(bounds_of(node, slot)),
                            indices_of(wide, node.child[slot]));
  std::sort(leaves.begin(), leaves.end());
  return leaves;
}

TEST(Wide, EveryNodeButTheRootHasOneParentBeforeIt) {
  for_each_subject([](const Subject& s) {
    std::vector<int> parents(s.wide.nodes.size(), 0);
    for (std::size_t i = 0; i < s.wide.nodes.size(); ++i)
      for (int slot = 0; slot < n_children(s.wide.nodes[i]); ++slot) {
        const u32 child = s.wide.nodes[i].child[slot];
        if (is_leaf(child)) continue;
        ASSERT_LT(child, s.wide.nodes.size());
        ASSERT_GT(child, i);  // so that all of them are below the root
        ++parents[child];
      }
    ASSERT_FALSE(parents.empty());
    EXPECT_EQ(parents[0], 0);
    EXPECT_EQ(std::count(parents.begin() + 1, parents.end(), 1), static_cast<long>(parents.size()) - 1);
  });
}

// Together with the test above: a path from the root leads to each of them, and no other path to any.
TEST(Wide, LeavesAreThoseOfTheBinaryTreeByKind) {
  std::size_t largest = 0;
  for_each_subject([&](const Subject& s) {
    const std::vector<Leaf> wanted = leaves_of(s.tree), found = leaves_of(s.wide);
    EXPECT_TRUE(found == wanted) << found.size() << " leaves, wanted " << wanted.size();
    for (const Leaf& leaf : found) largest = std::max(largest, std::get<2>(leaf).size());
  });
  EXPECT_GT(largest, 1000u);  // the fan's: leaves of many blocks were among them
}

TEST(Wide, BoundsAreThoseOfWhatIsBelow) {
  for_each_subject([](const Subject& s) {
    std::vector<Box> wanted(s.wide.nodes.size());  // a child's bounds as its parent has them
    wanted[0] = s.tree.contents[0];
    for (std::size_t i = 0; i < s.wide.nodes.size(); ++i) {
      const WideNode& node = s.wide.nodes[i];
      Box all;
      for (int slot = 0; slot < n_children(node); ++slot) {
        all.grow(bounds_of(node, slot));
        if (!is_leaf(node.child[slot])) wanted[node.child[slot]] = bounds_of(node, slot);
      }
      ASSERT_EQ(corners_of(all), corners_of(wanted[i])) << "node " << i;
    }
  });
}

TEST(Wide, SlotsWithoutChildHaveBoundsThatNoRayMeets) {
  for_each_subject([](const Subject& s) {
    for (const WideNode& node : s.wide.nodes)
      for (int slot = n_children(node); slot < 8; ++slot)
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_EQ(node.bounds[axis][0][slot], kInfinity);
          ASSERT_EQ(node.bounds[axis][1][slot], -kInfinity);
        }
  });
}

TEST(Wide, LooseCellsHaveEmptyOnesToSkip) {
  std::size_t n_empty = 0;
  for (const Subject& s : subjects())
    if (s.name.find("loose") != std::string::npos)
      for (const kdtree::Node& node : s.tree.nodes) n_empty += node.is_leaf() && node.right == 0 ? 1 : 0;
  EXPECT_GT(n_empty, 1000u);
}

template <class T>
void expect_same_bytes(const Array<T>& a, const Array<T>& b) {
  ASSERT_EQ(a.bytes(), b.bytes());
  EXPECT_TRUE(a.empty() || std::memcmp(a.data(), b.data(), a.bytes()) == 0);
}

// Large enough to be collapsed in many parts.
TEST(Wide, ThreadsDoNotShow) {
  Random random(kSeed);
  const scene::Geometry g = test::mixed_geometry(random, 8000, 0.3f);
  const kdtree::Tree tree = kdtree::build(g, {});
  const FlatScene flat = flat_of(g, tree);
  ASSERT_GT(tree.nodes.size(), 16384u);
  const auto made_by = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return make_wide(tree, flat, 4);
  };
  const WideForm one = made_by(1), four = made_by(4);
  EXPECT_EQ(one.stack_size, four.stack_size);
  expect_same_bytes(one.nodes, four.nodes);
  primitives::for_each_kind(
      [&](auto kind) { expect_same_bytes(decltype(kind)::blocks_of(one), decltype(kind)::blocks_of(four)); });
}

// ---- Blocks

// Each lane is of one leaf: the blocks are cut up by the leaves without rest or overlap.
TEST(Wide, LeavesShareNoBlockAndLeaveNone) {
  for_each_subject([](const Subject& s) {
    const auto block = static_cast<std::size_t>(s.wide.block);
    for (int kind = 0; kind < kKinds; ++kind) {
      std::vector<int> uses(blocks_of(s.wide, kind).size() / (kRows[kind] * block), 0);
      ASSERT_EQ(uses.size() * kRows[kind] * block, blocks_of(s.wide, kind).size());
      for (const WideNode& node : s.wide.nodes)
        for (int slot = 0; slot < n_children(node); ++slot) {
          if (!is_leaf(node.child[slot]) || kind_of(node.child[slot]) != kind) continue;
          const std::size_t first = node.child[slot] & KDRAY_WIDE_FIRST_MASK;
          const std::size_t n = (indices_of(s.wide, node.child[slot]).size() + block - 1) / block;
          ASSERT_LE(first + n, uses.size());
          for (std::size_t i = 0; i < n; ++i) ++uses[first + i];
        }
      EXPECT_EQ(std::count(uses.begin(), uses.end(), 1), static_cast<long>(uses.size()));
    }
  });
}

void expect_row(const Lane& lane, int first_row, const float* wanted, int n) {
  for (int k = 0; k < n; ++k)
    ASSERT_EQ(std::bit_cast<u32>(lane.number(first_row + k)), std::bit_cast<u32>(wanted[k])) << first_row + k;
}

void expect_primitive(const FlatScene& flat, int kind, const Lane& lane) {
  if (kind == 0) {
    ASSERT_LT(lane.index(), flat.triangles.size());
    expect_row(lane, 0, &flat.triangles[lane.index()].v[0][0], 9);
    ASSERT_TRUE(std::isfinite(lane.number(9)));
    return;
  }
  primitives::for_each_shape([&](auto k) {
    if (kind != static_cast<int>(k.kNumber)) return;
    const auto& shapes = decltype(k)::of(flat);
    ASSERT_LT(lane.index(), shapes.size());
    const auto rows = primitives::rows_of(shapes[lane.index()]);
    expect_row(lane, 0, rows.data(), static_cast<int>(rows.size()));
  });
}

// From the first that ends its leaf to the end of its block all lanes say so, and all but the first are
// empty.
TEST(Wide, LanesHoldTheirPrimitiveOrNothing) {
  for_each_subject([](const Subject& s) {
    for (int kind = 0; kind < kKinds; ++kind) {
      bool after_last = false;
      for (std::size_t i = 0; i < blocks_of(s.wide, kind).size() / kRows[kind]; ++i) {
        if (i % s.wide.block == 0) after_last = false;
        const Lane lane(s.wide, kind, i);
        if (after_last) {
          ASSERT_TRUE(lane.is_last());
          for (int row = 0; row + 1 < kRows[kind]; ++row) ASSERT_TRUE(std::isnan(lane.number(row))) << row;
        } else {
          ASSERT_NO_FATAL_FAILURE(expect_primitive(s.flat, kind, lane)) << "kind " << kind << " lane " << i;
        }
        after_last = lane.is_last();
      }
    }
  });
}

// ---- Order

TEST(Wide, OrderWordsArePermutations) {
  for_each_subject([](const Subject& s) {
    for (const WideNode& node : s.wide.nodes)
      for (const u32 word : node.order) {
        unsigned slots = 0;
        for (int k = 0; k < 8; ++k) slots |= 1u << (word >> 3 * k & 7u);
        ASSERT_EQ(slots, 0xffu);
        ASSERT_EQ(word >> 24, 0u);
      }
  });
}

// Whether a ray of the octant, along no plane, can leave a for b but not b for a: a point of b is ahead of
// one of a along every axis, and all of b along one of them.
bool must_precede(const Box& a, const Box& b, unsigned octant) {
  bool possible = true, apart = false;
  for (int k = 0; k < 3; ++k) {
    const bool negative = octant >> k & 1u;
    const float a_near = negative ? -a.hi[k] : a.lo[k], a_far = negative ? -a.lo[k] : a.hi[k];
    const float b_near = negative ? -b.hi[k] : b.lo[k], b_far = negative ? -b.lo[k] : b.hi[k];
    possible = possible && a_near < b_far;
    apart = apart || (a_far <= b_near && a_near < b_far);
  }
  return possible && apart;
}

TEST(Wide, ChildrenThatAPlanePartsAreOrderedByTheDirectionsSign) {
  std::size_t n_pairs = 0;
  for_each_of_planes([&](const Subject& s) {
    for (const WideNode& node : s.wide.nodes)
      for (unsigned octant = 0; octant < 8; ++octant)
        for (int far = 1; far < n_children(node); ++far)
          for (int near = 0; near < far; ++near) {
            const Box a = bounds_of(node, nth_slot(node, octant, near));
            const Box b = bounds_of(node, nth_slot(node, octant, far));
            ASSERT_FALSE(must_precede(b, a, octant) && !must_precede(a, b, octant)) << "octant " << octant;
            n_pairs += must_precede(a, b, octant);
          }
  });
  EXPECT_GT(n_pairs, 100000u);
}

struct TestRay {
  dvec3 origin, direction;

  unsigned octant() const {
    unsigned bits = 0;
    for (int k = 0; k < 3; ++k) bits |= std::signbit(direction[k]) ? 1u << k : 0u;
    return bits;
  }
  // Where the ray's line enters the box; infinity where it misses.
  double entry(const Box& b) const {
    double in = -kInfinity, out = kInfinity;
    for (int k = 0; k < 3; ++k) {
      const bool negative = std::signbit(direction[k]);
      in = std::max(in, ((negative ? b.hi[k] : b.lo[k]) - origin[k]) / direction[k]);
      out = std::min(out, ((negative ? b.lo[k] : b.hi[k]) - origin[k]) / direction[k]);
    }
    return in <= out ? in : kInfinity;
  }
};

TestRay random_ray(const Box& box, Random& random) {
  TestRay ray;
  for (int k = 0; k < 3; ++k) {
    ray.origin[k] = box.lo[k] + test::uniform(random, -0.5f, 1.5f) * (box.hi[k] - box.lo[k]);
    ray.direction[k] = (random() % 2 ? 1 : -1) * std::exp(test::uniform(random, -6, 0));
  }
  return ray;
}

// Kd cells are disjoint, and a plane's distance is the same number from both sides: no rounding to allow for.
TEST(Wide, MetChildrenComeFrontToBack) {
  Random random(kSeed + 1);
  std::size_t n_pairs = 0;
  for_each_of_planes([&](const Subject& s) {
    if (s.tree.refs.empty()) return;
    for (int i = 0; i < 60; ++i) {
      const TestRay ray = random_ray(s.tree.contents[0], random);
      std::vector<bool> met(s.wide.nodes.size(), false);  // parents come before their children
      met[0] = true;
      for (std::size_t n = 0; n < met.size(); ++n) {
        if (!met[n]) continue;
        const WideNode& node = s.wide.nodes[n];
        double last = -kInfinity;
        for (int k = 0; k < 8; ++k) {
          const int slot = nth_slot(node, ray.octant(), k);
          const double t = ray.entry(bounds_of(node, slot));
          if (t == kInfinity) continue;
          ASSERT_LT(slot, n_children(node));
          ASSERT_LE(last, t) << "child " << k;
          n_pairs += last > -kInfinity;
          last = t;
          if (!is_leaf(node.child[slot])) met.at(node.child[slot]) = true;
        }
      }
    }
  });
  EXPECT_GT(n_pairs, 5000u);
}

// ---- The stack

// What a walk stacks that pushes all children far to near, in the octant's order, and pops the nearest.
std::size_t most_stacked(const WideForm& wide, unsigned octant) {
  std::vector<u32> stack{0};
  std::size_t most = 0;
  while (!stack.empty()) {
    const u32 top = stack.back();
    stack.pop_back();
    if (is_leaf(top)) continue;
    const WideNode& node = wide.nodes[top];
    for (int k = 8; k-- > 0;) {
      const int slot = nth_slot(node, octant, k);
      if (slot >= n_children(node)) continue;
      EXPECT_GT(node.child[slot], top);  // or the walk would have no end
      if (node.child[slot] > top) stack.push_back(node.child[slot]);
    }
    most = std::max(most, stack.size());
  }
  return most;
}

TEST(Wide, StackSizeIsWhatTheWorstOctantNeeds) {
  for_each_subject([](const Subject& s) {
    std::size_t most = 0;
    for (unsigned octant = 0; octant < 8; ++octant) most = std::max(most, most_stacked(s.wide, octant));
    EXPECT_EQ(most, static_cast<std::size_t>(s.wide.stack_size));
  });
}

}  // namespace
}  // namespace kdray::flatten
