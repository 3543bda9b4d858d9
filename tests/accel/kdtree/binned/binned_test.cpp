// The binned builder: the same tree on every instruction set, clipping that contains what is there, planes
// that are the best there are.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "accel/kdtree/binned/binned.h"
#include "accel/kdtree/build.h"
#include "accel/kdtree/check_tree.h"
#include "accel/kdtree/integer_case.h"
#include "hwy/highway.h"

namespace kdray::test {
namespace {

using kdtree::BoundedRef;
using kdtree::Bounds;
using kdtree::BuildConfig;
using kdtree::Quality;
using kdtree::Tree;
namespace binned = kdtree::binned;

// ---- instruction sets

// Makes Highway dispatch to one instruction set while it lives.
class OnlyTarget {
 public:
  explicit OnlyTarget(std::int64_t target) { set(target); }
  ~OnlyTarget() { set(0); }
  OnlyTarget(const OnlyTarget&) = delete;
  OnlyTarget& operator=(const OnlyTarget&) = delete;

 private:
  static void set(std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

std::vector<std::int64_t> targets_of_this_machine() {
  hwy::SetSupportedTargetsForTest(0);
  std::vector<std::int64_t> targets{HWY_EMU128};
  for (std::int64_t target = 1; target != 0 && target < HWY_EMU128; target <<= 1)
    if ((hwy::SupportedTargets() & target) != 0) targets.push_back(target);
  return targets;
}

void expect_same(const Tree& a, const Tree& b) {
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  ASSERT_EQ(a.refs, b.refs);
  EXPECT_EQ(std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(kdtree::Node)), 0);
  EXPECT_EQ(std::memcmp(a.contents.data(), b.contents.data(), a.contents.size() * sizeof(Box)), 0);
}

TEST(Binned, InstructionSetsDoNotShow) {
  Random random(31);
  for (const int block : {1, 4, 8}) {
    scene::Geometry g = mixed_geometry(random, 12000, 0.3f);
    add_architecture(g, random, 1000);
    for (const Quality quality : {Quality::fast, Quality::balanced}) {
      BuildConfig config;
      config.quality = quality;
      config.block = block;
      config.groups = quality == Quality::balanced;
      const Tree best = kdtree::build(g, config);
      int n_targets = 0;
      for (const std::int64_t target : targets_of_this_machine()) {
        SCOPED_TRACE(hwy::TargetName(target));
        const OnlyTarget only(target);
        expect_same(kdtree::build(g, config), best);
        ++n_targets;
      }
      EXPECT_GE(n_targets, 2);  // what every machine has, and what this one has
    }
  }
}

// ---- clipping

struct Parts {
  Bounds below = kdtree::no_bounds(), above = kdtree::no_bounds();
};

Parts divide_one(const scene::Geometry& g, const Bounds& known, int axis, float position) {
  std::array<BoundedRef, 2> refs{
      BoundedRef{known.lo, kdtree::make_ref(scene::PrimitiveKind::triangle, 0), known.hi}, BoundedRef()};
  binned::Workspace workspace;
  const binned::Divided sides = binned::divide(g, {}, std::span(refs).first(1), {axis, position}, workspace);
  Parts parts;
  if (sides.n_below > 0) parts.below = refs[0].bounds();
  if (sides.n_above > 0) parts.above = workspace.above[0].bounds();
  return parts;
}

void expect_contains(const Bounds& found, const ExactBounds& exact, float offset, float scale) {
  for (int k = 0; k < 3; ++k) {
    EXPECT_LE(excess(found.lo[k], exact.lo[k], offset, scale), 0) << "axis " << k;
    EXPECT_GE(excess(found.hi[k], exact.hi[k], offset, scale), 0) << "axis " << k;
  }
}

void expect_tight(const Bounds& found, const ExactBounds& exact, float offset, float scale, int size) {
  // The pads: 8u of the edge, 4u of the coordinate, and the rounding of the result; and what is for
  // underflow.
  const long double loose =
      8.0L * std::numeric_limits<float>::epsilon() * (std::abs(offset) + 2 * size) + 0x1p-139L / scale;
  for (int k = 0; k < 3; ++k) {
    EXPECT_GE(excess(found.lo[k], exact.lo[k], offset, scale), -loose) << "axis " << k;
    EXPECT_LE(excess(found.hi[k], exact.hi[k], offset, scale), loose) << "axis " << k;
  }
}

void check_side(const Bounds& found, const std::optional<ExactBounds>& exact, bool whole, float offset,
                float scale, int size) {
  if (!exact) return;  // bounds may be kept that hold nothing
  ASSERT_FALSE(found.empty());
  expect_contains(found, *exact, offset, scale);
  if (whole) expect_tight(found, *exact, offset, scale, size);
}

void check_integer_cases(std::uint64_t seed, int size, float offset, float scale) {
  SCOPED_TRACE(testing::Message() << "seed " << seed << " offset " << offset << " scale " << scale);
  Random random(seed);
  int n_straddling = 0;
  for (int trial = 0; trial < 30000 && !testing::Test::HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    const IntegerCase c = random_case(random, size);
    scene::Geometry g;
    g.triangles = Array<scene::TriangleGeometry>(1);
    scene::TriangleGeometry& t = g.triangles[0] = {};
    for (std::size_t v = 0; v < 3; ++v)
      for (int k = 0; k < 3; ++k)
        t.v[v][k] = to_float(c.triangle[v][static_cast<std::size_t>(k)], offset, scale);
    const Bounds own = kdtree::bounds_from(scene::bounds_of(t));
    const Bounds known = kdtree::intersection(own, to_bounds(c.lo, c.hi, offset, scale));
    const auto axis = static_cast<std::size_t>(c.axis);
    const float plane = to_float(c.plane, offset, scale);
    if (known.empty() || !(known.lo[axis] < plane && plane < known.hi[axis])) continue;
    ++n_straddling;
    Point below_hi = c.hi, above_lo = c.lo;
    below_hi[axis] = above_lo[axis] = c.plane;
    const Parts parts = divide_one(g, known, c.axis, plane);
    const bool whole = known.lo == own.lo && known.hi == own.hi;
    check_side(parts.below, exact_clip(c.triangle, c.lo, below_hi), whole, offset, scale, size);
    check_side(parts.above, exact_clip(c.triangle, above_lo, c.hi), whole, offset, scale, size);
  }
  EXPECT_GT(n_straddling, 3000);
}

TEST(BinnedClip, ContainsIntegerParts) {
  check_integer_cases(41, 40, 0, 1);
}
TEST(BinnedClip, ContainsPartsOnACoarseGrid) {
  check_integer_cases(42, 4, 0, 1);
}
TEST(BinnedClip, ContainsPartsFarFromTheOrigin) {
  check_integer_cases(43, 30, 131072, 1);
}
TEST(BinnedClip, ContainsTinyParts) {
  check_integer_cases(44, 30, 0, 0x1p-100f);
}
TEST(BinnedClip, ContainsDenormalParts) {
  check_integer_cases(45, 30, 0, 0x1p-145f);
}
TEST(BinnedClip, ContainsHugeParts) {
  check_integer_cases(46, 30, 0, 0x1p+110f);
}

// ---- planes

// The least cost of all planes at the references' own bounds, by the plain definition in long double.
long double naive_least(const std::vector<BoundedRef>& refs, const Bounds& contents,
                        const BuildConfig& config) {
  const auto area = [](const std::array<long double, 3>& e) {
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
  };
  const auto tests = [&](std::size_t n) {
    const auto b = static_cast<std::size_t>(config.block);
    return static_cast<long double>((n + b - 1) / b) + (b > 1 ? 1e-3L * static_cast<long double>(n) : 0.0L);
  };
  std::array<long double, 3> size;
  for (std::size_t k = 0; k < 3; ++k) size[k] = static_cast<long double>(contents.hi[k]) - contents.lo[k];
  const long double traverse =
      static_cast<long double>(config.cost_traverse) * kdtree::traverse_factor(config.quality);
  long double least = std::numeric_limits<long double>::infinity();
  for (std::size_t k = 0; k < 3; ++k)
    for (const BoundedRef& r : refs)
      for (const float s : {r.lo[k], r.hi[k]}) {
        if (!(contents.lo[k] < s && s < contents.hi[k])) continue;
        std::size_t n_below = 0, n_above = 0;
        for (const BoundedRef& q : refs) {
          n_below += q.lo[k] < s || q.hi[k] <= s ? 1 : 0;
          n_above += q.hi[k] > s ? 1 : 0;
        }
        std::array<long double, 3> below = size, above = size;
        below[k] = static_cast<long double>(s) - contents.lo[k];
        above[k] = static_cast<long double>(contents.hi[k]) - s;
        least = std::min(least, traverse + config.cost_intersect *
                                               (area(below) * tests(n_below) + area(above) * tests(n_above)) /
                                               area(size));
      }
  return least;
}

struct SmallScene {
  scene::Geometry geometry;
  std::vector<BoundedRef> refs;
  Bounds contents;
};

SmallScene small_scene(Random& random, int n) {
  SmallScene s;
  if (random() % 3 == 0) {
    add_architecture(s.geometry, random, n);
  } else {
    add_triangles(s.geometry, random, n, uniform(random, 0.1f, 8));
  }
  for (std::size_t i = 0; i < s.geometry.triangles.size(); ++i) {
    const Bounds b = kdtree::bounds_from(scene::bounds_of(s.geometry.triangles[i]));
    s.refs.push_back(
        {b.lo, kdtree::make_ref(scene::PrimitiveKind::triangle, static_cast<std::uint32_t>(i)), b.hi});
  }
  s.contents = kdtree::hull_of(s.refs);
  return s;
}

// A tree of depth 1 tells which plane the root was given.
TEST(BinnedPlane, SmallCellsGetTheBestOfAll) {
  Random random(51);
  int n_split = 0;
  for (int trial = 0; trial < 2000 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    const SmallScene s = small_scene(random, 2 + static_cast<int>(random() % 30));
    if (s.refs.size() > 48) continue;
    BuildConfig config;
    config.max_depth = 1;
    config.block = 1 << random() % 4;
    config.cost_intersect = uniform(random, 1, 20);
    const Tree tree = kdtree::build(s.geometry, config);
    const long double least = naive_least(s.refs, s.contents, config);
    const auto n = static_cast<long double>(s.refs.size());
    const auto block = static_cast<long double>(config.block);
    const long double leaf =
        config.cost_intersect * (std::ceil(n / block) + (config.block > 1 ? 1e-3L * n : 0.0L));
    if (tree.nodes.size() == 1) {
      EXPECT_GE(least, leaf * (1 - 1e-5L));
      continue;
    }
    ++n_split;
    EXPECT_LE(least, leaf * (1 + 1e-5L));
    // The plane's own cost, by the same definition, over one plane.
    const kdtree::Node& root = tree.nodes[0];
    std::vector<BoundedRef> one{
        {{root.split, root.split, root.split}, 0, {root.split, root.split, root.split}}};
    const std::size_t k = root.axis;
    EXPECT_TRUE(std::any_of(s.refs.begin(), s.refs.end(), [&](const BoundedRef& r) {
      return r.lo[k] == root.split || r.hi[k] == root.split;
    }));
    std::size_t n_below = 0, n_above = 0;
    for (const BoundedRef& q : s.refs) {
      n_below += q.lo[k] < root.split || q.hi[k] <= root.split ? 1 : 0;
      n_above += q.hi[k] > root.split ? 1 : 0;
    }
    std::array<long double, 3> e;
    for (std::size_t a = 0; a < 3; ++a) e[a] = static_cast<long double>(s.contents.hi[a]) - s.contents.lo[a];
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const auto share = [&](long double length) {
      return (e[i] * e[j] + length * (e[i] + e[j])) / (e[0] * e[1] + e[1] * e[2] + e[2] * e[0]);
    };
    const auto tests = [&](std::size_t m) {
      return std::ceil(static_cast<long double>(m) / block) +
             (config.block > 1 ? 1e-3L * static_cast<long double>(m) : 0.0L);
    };
    const long double cost =
        config.cost_traverse * kdtree::traverse_factor(config.quality) +
        config.cost_intersect *
            (share(root.split - static_cast<long double>(s.contents.lo[k])) * tests(n_below) +
             share(static_cast<long double>(s.contents.hi[k]) - root.split) * tests(n_above));
    EXPECT_NEAR(static_cast<double>(cost), static_cast<double>(least), 1e-4 * static_cast<double>(least));
  }
  EXPECT_GT(n_split, 500);
}

// Planes from bins, refined, are almost as good as the best of all.
TEST(BinnedPlane, LargerCellsGetAlmostTheBest) {
  Random random(52);
  for (int trial = 0; trial < 20; ++trial) {
    SCOPED_TRACE(trial);
    scene::Geometry g;
    add_triangles(g, random, 1000, uniform(random, 0.1f, 2));
    BuildConfig binned_config, exact_config;
    binned_config.max_depth = exact_config.max_depth = 1;
    exact_config.quality = Quality::best;
    const Tree tree = kdtree::build(g, binned_config), exact = kdtree::build(g, exact_config);
    ASSERT_EQ(tree.nodes.size(), exact.nodes.size());
    const auto cost = [&](const Tree& t) {
      double sum = 0;
      for (const kdtree::Node& n : t.nodes)
        if (n.is_leaf())
          sum += double(t.contents[static_cast<std::size_t>(&n - t.nodes.data())].area()) * n.right;
      return sum;
    };
    EXPECT_LT(cost(tree), 1.02 * cost(exact));
  }
}

}  // namespace
}  // namespace kdray::test
