// The builder's search for the best plane against the naive one: the same cost, and a plane that has it.
#include "accel/kdtree/exact/exact.h"

#include <gtest/gtest.h>

#include "accel/kdtree/exact/naive_split.h"
#include "accel/kdtree/shapes.h"

namespace kdray::test {
namespace {

using kdtree::BoundedRef;
using kdtree::Bounds;
using kdtree::BuildConfig;
using kdtree::Split;

struct Cell {
  std::vector<BoundedRef> refs;
  Bounds bounds;
};

void check_against_naive(const Cell& cell, const BuildConfig& config, const Split& split, bool only_useful) {
  const NaiveSplit naive = naive_split(cell.refs, cell.bounds, config);
  const long double leaf = config.cost_intersect * naive_tests(cell.refs.size(), config);
  if (naive.axis < 0 || (only_useful && naive.cost >= leaf * (1 - 1e-12L))) {
    // No plane at all, or none worth having: whatever was found must not look better than it is.
    EXPECT_TRUE(!split.found() || split.cost >= static_cast<double>(leaf) * (1 - 1e-11));
    return;
  }
  ASSERT_TRUE(split.found());
  EXPECT_NEAR(split.cost, static_cast<double>(naive.cost), 1e-12 * static_cast<double>(naive.cost));
  const long double found =
      naive_cost(cell.refs, cell.bounds, config, split.axis, split.position, split.planar_below);
  EXPECT_NEAR(static_cast<double>(found), static_cast<double>(naive.cost),
              1e-12 * static_cast<double>(naive.cost));
}

void check_cell(const Cell& cell, const BuildConfig& config) {
  kdtree::SweepScratch scratch;
  check_against_naive(cell, config, kdtree::find_split(cell.refs, cell.bounds, config, scratch),
                      cell.refs.size() > kdtree::kSmallSweep);
  check_against_naive(cell, config, kdtree::sweep(cell.refs, cell.bounds, config, scratch), true);
}

// What the cell around some boxes may look like: tight, or with empty space on some sides.
Cell cell_of(std::vector<BoundedRef> refs, Random& random) {
  Bounds b = refs[0].bounds();
  for (const BoundedRef& r : refs) b = kdtree::hull(b, r.bounds());
  for (int k = 0; k < 3; ++k) {
    if (random() % 3 == 0) b.lo[k] -= uniform(random, 0, 5);
    if (random() % 3 == 0) b.hi[k] += uniform(random, 0, 5);
  }
  return {std::move(refs), b};
}

std::vector<BoundedRef> boxes_of(const scene::Geometry& g) {
  std::vector<BoundedRef> refs;
  const auto add = [&](const Box& box) {
    const Bounds b = kdtree::bounds_from(box);
    refs.push_back({b.lo, static_cast<kdtree::Ref>(refs.size()), b.hi});
  };
  primitives::for_each_kind([&](auto kind) {
    for (const auto& p : decltype(kind)::of(g)) add(scene::bounds_of(p));
  });
  return refs;
}

// Boxes with corners on a coarse grid: ties, duplicates, flat boxes, boxes on the cell's boundary.
std::vector<BoundedRef> grid_boxes(Random& random, int n, int steps) {
  std::vector<BoundedRef> refs;
  for (int i = 0; i < n; ++i) {
    BoundedRef r{};
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<float>(random() % steps), b = static_cast<float>(random() % steps);
      r.lo[k] = std::min(a, b);
      r.hi[k] = random() % 4 == 0 ? r.lo[k] : std::max(a, b);
    }
    refs.push_back(r);
  }
  return refs;
}

int size_of(Random& random, int trial) {
  return 1 + static_cast<int>(random() % (trial % 3 == 0 ? 8 : (trial % 3 == 1 ? 40 : 150)));
}

BuildConfig config_of(Random& random) {
  BuildConfig c;
  constexpr int kBlocks[] = {1, 4, 8};
  c.block = kBlocks[random() % 3];
  if (random() % 2 == 0) return c;
  c.cost_traverse = uniform(random, 0, 4);
  c.cost_intersect = uniform(random, 0.5f, 4);
  c.empty_bonus = random() % 2 == 0 ? 1.0 : uniform(random, 0.3f, 1);
  return c;
}

TEST(Split, BoxesOfRandomPrimitives) {
  constexpr std::uint64_t kSeed = 1;
  SCOPED_TRACE(kSeed);
  Random random(kSeed);
  for (int trial = 0; trial < 1200 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    const scene::Geometry g = mixed_geometry(random, size_of(random, trial), trial % 2 == 0 ? 0.5f : 4);
    check_cell(cell_of(boxes_of(g), random), config_of(random));
  }
}

TEST(Split, BoxesOnAGrid) {
  constexpr std::uint64_t kSeed = 2;
  SCOPED_TRACE(kSeed);
  Random random(kSeed);
  for (int trial = 0; trial < 3000 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    check_cell(cell_of(grid_boxes(random, size_of(random, trial), 2 + trial % 20), random),
               config_of(random));
  }
}

TEST(Split, ArchitectureAndFlatCells) {
  constexpr std::uint64_t kSeed = 3;
  SCOPED_TRACE(kSeed);
  Random random(kSeed);
  for (int trial = 0; trial < 600 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    scene::Geometry g;
    add_architecture(g, random, size_of(random, trial));
    Cell cell = cell_of(boxes_of(g), random);
    if (trial % 4 == 0) {  // a floor alone: the cell is flat
      for (BoundedRef& r : cell.refs) r.lo[2] = r.hi[2] = 1;
      cell.bounds.lo[2] = cell.bounds.hi[2] = 1;
    }
    check_cell(cell, config_of(random));
  }
}

// Far-off coordinates and tiny extents: bins are as narrow as floats.
TEST(Split, ClustersOfNeighbouringFloats) {
  constexpr std::uint64_t kSeed = 4;
  SCOPED_TRACE(kSeed);
  Random random(kSeed);
  for (int trial = 0; trial < 600 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    const float offset = trial % 2 == 0 ? 1e6f : -1e-38f, step = trial % 2 == 0 ? 0.0625f : 1e-41f;
    std::vector<BoundedRef> refs = grid_boxes(random, size_of(random, trial), 50);
    for (BoundedRef& r : refs) {
      for (int k = 0; k < 3; ++k) {
        r.lo[k] = offset + r.lo[k] * step;
        r.hi[k] = offset + r.hi[k] * step;
      }
    }
    Bounds b = refs[0].bounds();
    for (const BoundedRef& r : refs) b = kdtree::hull(b, r.bounds());
    if (!(kdtree::half_area(b) > 0)) continue;
    check_cell({std::move(refs), b}, config_of(random));
  }
}

// Enough references for the search that all threads share.
TEST(Split, LargeCell) {
  constexpr std::uint64_t kSeed = 5;
  SCOPED_TRACE(kSeed);
  Random random(kSeed);
  for (const int steps : {9, 40, 150}) check_cell(cell_of(grid_boxes(random, 20000, steps), random), {});
  // A few lattice planes more than bins, and boxes small enough for a split to pay.
  std::vector<BoundedRef> refs;
  for (int i = 0; i < 20000; ++i) {
    BoundedRef r{};
    for (int k = 0; k < 3; ++k) {
      r.lo[k] = static_cast<float>(random() % 700);
      r.hi[k] = r.lo[k] + static_cast<float>(random() % 30);
    }
    refs.push_back(r);
  }
  const Cell cell = cell_of(std::move(refs), random);
  for (const int block : {1, 4, 8}) {
    SCOPED_TRACE(block);
    BuildConfig config;
    config.block = block;
    check_cell(cell, config);
  }
}

TEST(Split, ALeafCostsItsBlocks) {
  BuildConfig config;
  for (const std::uint32_t n : {0u, 1u, 9u}) EXPECT_EQ(kdtree::LeafCost(config)(n), n);
  config.block = 8;
  const kdtree::LeafCost cost(config);
  EXPECT_EQ(cost(0), 0);
  EXPECT_DOUBLE_EQ(cost(1), 1.001);
  EXPECT_DOUBLE_EQ(cost(8), 1.008);
  EXPECT_DOUBLE_EQ(cost(9), 2.009);
  // No split pays for itself where all fit a block; one test at a time, it would.
  Cell cell{{}, {{0, 0, 0}, {8, 1, 1}}};
  for (int i = 0; i < 8; ++i) {
    const auto x = static_cast<float>(i);
    cell.refs.push_back({{x, 0, 0}, 0, {x + 1, 1, 1}});
  }
  kdtree::SweepScratch scratch;
  EXPECT_GT(kdtree::find_split(cell.refs, cell.bounds, config, scratch).cost, 3 * 1.008);
  EXPECT_LT(kdtree::find_split(cell.refs, cell.bounds, {}, scratch).cost, 3 * 8);
}

TEST(Split, PlanarReferencesGoToTheCheaperSide) {
  // A floor of ten, and twice as many that begin well above it.
  Cell cell;
  cell.bounds = {{0, 0, 0}, {1, 1, 8}};
  for (int i = 0; i < 10; ++i) cell.refs.push_back({{0, 0, 0}, 0, {1, 1, 0}});
  for (int i = 0; i < 20; ++i) cell.refs.push_back({{0, 0, 6}, 0, {1, 1, 8}});
  kdtree::SweepScratch scratch;
  // Half areas: cell 17, up to 6: 13, from 6: 5, floor 1. At 6: 13*10 + 5*20; at 0: 1*10 + 17*20.
  const Split split = kdtree::find_split(cell.refs, cell.bounds, {}, scratch);
  EXPECT_EQ(split.axis, 2);
  EXPECT_EQ(split.position, 6);
  // Once that is done the floor gets the flat cell.
  Cell lower{{cell.refs.begin(), cell.refs.begin() + 10}, {{0, 0, 0}, {1, 1, 6}}};
  const Split floor = kdtree::find_split(lower.refs, lower.bounds, {}, scratch);
  EXPECT_EQ(floor.axis, 2);
  EXPECT_EQ(floor.position, 0);
  EXPECT_TRUE(floor.planar_below);
}

TEST(Split, NothingToFind) {
  kdtree::SweepScratch scratch;
  EXPECT_FALSE(kdtree::find_split({}, {{0, 0, 0}, {1, 1, 1}}, {}, scratch).found());
  const std::vector<BoundedRef> line{{{0, 0, 0}, 0, {1, 0, 0}}};
  EXPECT_FALSE(kdtree::find_split(line, {{0, 0, 0}, {2, 0, 0}}, {}, scratch).found());
  const std::vector<BoundedRef> full{{{0, 0, 0}, 0, {1, 1, 1}}};
  EXPECT_FALSE(kdtree::find_split(full, {{0, 0, 0}, {1, 1, 1}}, {}, scratch).found());
}

TEST(Events, OrderIsThatOfPositionsThenKinds) {
  using kdtree::EventKind;
  const float positions[] = {-3e38f, -1.5f, -1e-45f, 0.0f, 1e-45f, 2, 3e38f};
  kdtree::Event previous = 0;
  for (const float p : positions) {
    for (const EventKind kind : {EventKind::end, EventKind::planar, EventKind::start}) {
      const kdtree::Event e = kdtree::make_event(p, kind);
      EXPECT_LT(previous, e);
      EXPECT_EQ(kdtree::position_of(e), p);
      EXPECT_EQ(kdtree::kind_of(e), kind);
      previous = e;
    }
  }
  EXPECT_EQ(kdtree::make_event(-0.0f, EventKind::end), kdtree::make_event(0.0f, EventKind::end));
}

}  // namespace
}  // namespace kdray::test
