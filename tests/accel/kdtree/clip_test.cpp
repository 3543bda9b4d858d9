// Clipped bounds against exact arithmetic (triangles) and closed forms (shapes).
#include "accel/kdtree/clip.h"

#include <gtest/gtest.h>

#include <cmath>

#include "accel/kdtree/check_tree.h"
#include "accel/kdtree/exact_clip.h"
#include "accel/kdtree/integer_case.h"
#include "accel/kdtree/shapes.h"
#include "base/box.h"
#include "support/all_kinds.h"

namespace kdray::test {
namespace {

using kdtree::Bounds;

// ---- triangles
// -----------------------------------------------------------------------------------------------------

void check_part(const Bounds& found, const std::optional<ExactBounds>& exact, float offset, float scale,
                int size) {
  ASSERT_EQ(found.empty(), !exact.has_value());
  if (!exact) return;
  // As tight as floats are: one step outward, and one more for the clipping's own margin next to a float.
  const long double loose = 2.0L * std::numeric_limits<float>::epsilon() * (std::abs(offset) + size);
  for (int k = 0; k < 3; ++k) {
    const long double below = excess(found.lo[k], exact->lo[k], offset, scale);
    const long double above = excess(found.hi[k], exact->hi[k], offset, scale);
    EXPECT_LE(below, 0) << "axis " << k;
    EXPECT_GE(above, 0) << "axis " << k;
    EXPECT_GE(below, -loose) << "axis " << k;
    EXPECT_LE(above, loose) << "axis " << k;
  }
}

void check_integer_clips(std::uint64_t seed, int size, float offset, float scale) {
  SCOPED_TRACE(testing::Message() << "seed " << seed << " offset " << offset << " scale " << scale);
  Random random(seed);
  int n_both = 0, n_empty = 0;
  for (int trial = 0; trial < 30000 && !testing::Test::HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    const IntegerCase c = random_case(random, size);
    scene::TriangleGeometry t{};
    for (int v = 0; v < 3; ++v) {
      for (int k = 0; k < 3; ++k) t.v[v][k] = to_float(c.triangle[v][k], offset, scale);
    }
    const Bounds cell = to_bounds(c.lo, c.hi, offset, scale);
    const Bounds known = kdtree::intersection(cell, kdtree::bounds_from(scene::bounds_of(t)));
    const kdtree::SplitBounds parts =
        kdtree::clip_triangle(t, known, cell, c.axis, to_float(c.plane, offset, scale));
    Point below_hi = c.hi, above_lo = c.lo;
    below_hi[c.axis] = above_lo[c.axis] = c.plane;
    const auto below = exact_clip(c.triangle, c.lo, below_hi), above = exact_clip(c.triangle, above_lo, c.hi);
    check_part(parts.below, below, offset, scale, size);
    check_part(parts.above, above, offset, scale, size);
    n_both += below && above;
    n_empty += !below && !above;
  }
  EXPECT_GT(n_both, 1000);  // the cases are not all alike
  EXPECT_GT(n_empty, 1000);
}

TEST(ClipTriangle, IsExactOnIntegers) {
  check_integer_clips(1, 40, 0, 1);
}
TEST(ClipTriangle, IsExactOnACoarseGrid) {
  check_integer_clips(2, 3, 0, 1);
}
TEST(ClipTriangle, IsExactFarFromTheOrigin) {
  check_integer_clips(3, 30, 131072, 1);
}
TEST(ClipTriangle, IsExactWhenTiny) {
  check_integer_clips(4, 30, 0, 0x1p-120f);
}
TEST(ClipTriangle, IsExactWhenHuge) {
  check_integer_clips(5, 30, 0, 0x1p+110f);
}

// Floats of very different size: points of the triangle, exact in 128 bits, must be in the bounds of their
// side.
struct FixedPoint {
  static constexpr int kShareBits = 12;  // barycentric weights are multiples of 2^-12
  using Integer = __int128;              // coordinates are multiples of 2^-40
  static float quantise(float x) { return static_cast<float>(std::round(x * 0x1p40) * 0x1p-40); }
  static Integer of(float x) { return static_cast<Integer>(static_cast<long double>(x) * 0x1p40L); }
  static Integer shared(float x) { return of(x) << kShareBits; }
};

TEST(ClipTriangle, ContainsItsPoints) {
  constexpr std::uint64_t kSeed = 6;
  SCOPED_TRACE(kSeed);
  Random random(kSeed);
  const auto coordinate = [&](float reach) {
    const float x = uniform(random, -reach, reach);
    return FixedPoint::quantise(random() % 3 == 0 ? x * std::exp2(-uniform(random, 0, 20)) : x);
  };
  int n_inside = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    SCOPED_TRACE(trial);
    const float reach = trial % 2 == 0 ? 1.0f : 500.0f;
    scene::TriangleGeometry t{};
    for (auto& v : t.v)
      for (float& x : v) x = coordinate(reach);
    for (int k = 0; k < 3; ++k) {
      if (trial % 5 == 0) t.v[2][k] = t.v[0][k] + (t.v[1][k] - t.v[0][k]) * 0.5f;  // a needle
      t.v[2][k] = FixedPoint::quantise(t.v[2][k]);
    }
    Bounds cell;
    for (int k = 0; k < 3; ++k) {
      const float a = coordinate(reach), b = coordinate(reach);
      cell.lo[k] = std::min(a, b), cell.hi[k] = std::max(a, b);
    }
    const int axis = trial % 3;
    const float plane = std::clamp(coordinate(reach), cell.lo[axis], cell.hi[axis]);
    const Bounds known = kdtree::intersection(cell, kdtree::bounds_from(scene::bounds_of(t)));
    const kdtree::SplitBounds parts = kdtree::clip_triangle(t, known, cell, axis, plane);
    for (int sample = 0; sample < 300; ++sample) {
      const int whole = 1 << FixedPoint::kShareBits;
      int i = static_cast<int>(random() % (whole + 1)), j = static_cast<int>(random() % (whole - i + 1));
      if (sample % 3 == 0) j = whole - i;  // on an edge
      FixedPoint::Integer p[3];
      for (int k = 0; k < 3; ++k)
        p[k] = FixedPoint::of(t.v[0][k]) * i + FixedPoint::of(t.v[1][k]) * j +
               FixedPoint::of(t.v[2][k]) * (whole - i - j);
      const auto inside = [&](const Bounds& b) {
        for (int k = 0; k < 3; ++k) {
          if (p[k] < FixedPoint::shared(b.lo[k]) || p[k] > FixedPoint::shared(b.hi[k])) return false;
        }
        return true;
      };
      if (!inside(cell)) continue;
      ++n_inside;
      if (p[axis] <= FixedPoint::shared(plane)) {
        ASSERT_FALSE(parts.below.empty());
        ASSERT_TRUE(inside(parts.below));
      }
      if (p[axis] >= FixedPoint::shared(plane)) {
        ASSERT_FALSE(parts.above.empty());
        ASSERT_TRUE(inside(parts.above));
      }
    }
  }
  EXPECT_GT(n_inside, 10000);
}

// ---- shapes
// ---------------------------------------------------------------------------------------------

// `found` must contain [lo, hi] and be no looser than rounding.
void expect_bounds(const Bounds& found, const std::array<double, 3>& lo, const std::array<double, 3>& hi) {
  ASSERT_FALSE(found.empty());
  for (int k = 0; k < 3; ++k) {
    EXPECT_LE(found.lo[k], lo[k] + 1e-15);
    EXPECT_GE(found.hi[k], hi[k] - 1e-15);
    EXPECT_NEAR(found.lo[k], lo[k], 1e-6);
    EXPECT_NEAR(found.hi[k], hi[k], 1e-6);
  }
}

TEST(ClipSphere, ClosedForms) {
  const scene::SphereGeometry unit{{0, 0, 0}, 1, 0};
  expect_bounds(primitives::clip(unit, {{-2, -2, -2}, {2, 2, 2}}), {-1, -1, -1}, {1, 1, 1});
  const double cap = std::sqrt(0.75);
  expect_bounds(primitives::clip(unit, {{0.5f, -2, -2}, {2, 2, 2}}), {0.5, -cap, -cap}, {1, cap, cap});
  // A rod that begins inside: the surface is where it comes out.
  const float w = 0.125f;
  expect_bounds(primitives::clip(unit, {{-0.5f, -w, -w}, {2, w, w}}), {std::sqrt(1 - 2.0 * w * w), -w, -w},
                {1, w, w});
  expect_bounds(primitives::clip(unit, {{1, -1, -1}, {3, 1, 1}}), {1, 0, 0}, {1, 0, 0});  // touched
}

TEST(ClipSphere, DropsWhatHoldsNoSurface) {
  const scene::SphereGeometry s{{1, 2, 3}, 2, 0};
  EXPECT_TRUE(primitives::clip(s, {{0, 1, 2}, {2, 3, 4}}).empty());           // inside
  EXPECT_TRUE(primitives::clip(s, {{2.5f, 3.5f, 4.5f}, {5, 5, 5}}).empty());  // off the corner of its box
  EXPECT_TRUE(primitives::clip(s, {{3.001f, 0, 0}, {4, 9, 9}}).empty());      // beside it
  EXPECT_FALSE(primitives::clip(s, {{3, 0, 0}, {4, 9, 9}}).empty());          // touching
  EXPECT_FALSE(primitives::clip(s, {{0, 1, 2}, {2, 3, 5}}).empty());          // one corner pokes out
}

TEST(ClipCone, ClosedForms) {
  const scene::ConeGeometry cylinder{{0, 0, 0}, {0, 0, 10}, 1, 1, 0};
  expect_bounds(primitives::clip(cylinder, {{-9, -9, 2}, {9, 9, 3}}), {-1, -1, 2}, {1, 1, 3});
  EXPECT_TRUE(primitives::clip(cylinder, {{-0.5f, -0.5f, 2}, {0.5f, 0.5f, 3}}).empty());  // inside
  EXPECT_TRUE(
      primitives::clip(cylinder, {{-0.5f, -0.5f, -5}, {0.5f, 0.5f, 30}}).empty());  // through: no caps
  EXPECT_TRUE(primitives::clip(cylinder, {{-9, -9, 10.5f}, {9, 9, 20}}).empty());
  const scene::ConeGeometry pointed{{0, 0, 0}, {0, 0, 4}, 2, 0, 0};
  expect_bounds(primitives::clip(pointed, {{-9, -9, 2}, {9, 9, 9}}), {-1, -1, 2}, {1, 1, 4});
  expect_bounds(primitives::clip(pointed, {{-9, -9, 4}, {9, 9, 9}}), {0, 0, 4}, {0, 0, 4});
  // Only the circles near the base reach out there.
  expect_bounds(primitives::clip(pointed, {{1, -9, -9}, {9, 9, 9}}), {1, -2, 0}, {2, 2, 2});
}

TEST(ClipDisc, ClosedForms) {
  const scene::DiscGeometry flat{{0, 0, 1}, {0, 0, 1}, 2, 0};
  expect_bounds(primitives::clip(flat, {{-9, -9, 0}, {9, 9, 2}}), {-2, -2, 1}, {2, 2, 1});
  const double chord = std::sqrt(3.0);
  expect_bounds(primitives::clip(flat, {{1, -9, 0}, {9, 9, 2}}), {1, -chord, 1}, {2, chord, 1});
  EXPECT_TRUE(primitives::clip(flat, {{-9, -9, 1.5f}, {9, 9, 2}}).empty());   // above it
  EXPECT_TRUE(primitives::clip(flat, {{1.5f, 1.5f, 0}, {9, 9, 2}}).empty());  // off the corner of its box
  EXPECT_FALSE(
      primitives::clip(flat, {{-0.5f, -0.5f, 1}, {0.5f, 0.5f, 2}}).empty());  // touched; it is filled
  // A slanted one: the box's floor cuts it along a chord.
  const float half = std::sqrt(0.5f);
  const scene::DiscGeometry slanted{{0, 0, 0}, {half, 0, half}, 2, 0};
  expect_bounds(primitives::clip(slanted, {{-9, -9, 0}, {9, 9, 9}}), {-std::sqrt(2.0), -2, 0},
                {0, 2, std::sqrt(2.0)});
  EXPECT_TRUE(primitives::clip(slanted, {{0.25f, -9, 0.25f}, {9, 9, 9}}).empty());  // its plane passes by
}

// Points of the surface in random boxes lie in the bounds, but for the point's own rounding.
template <class Kind>
void check_samples(const scene::Geometry& g, Random& random) {
  constexpr double kRounding = 1e-14;  // of points of size 20 in double
  int n_inside = 0;
  Draw draw(random());
  const auto point = [&](const auto& p) { return dvec3(Samples<Kind>::point(p, draw)); };
  for (const auto& p : Kind::of(g)) {
    for (int trial = 0; trial < 20; ++trial) {
      const dvec3 middle = point(p);
      Bounds box;
      for (int k = 0; k < 3; ++k) {
        box.lo[k] = static_cast<float>(middle[k]) - uniform(random, 0, 1);
        box.hi[k] = static_cast<float>(middle[k]) + uniform(random, 0, 1);
      }
      const Bounds found = clip(p, box);
      for (int sample = 0; sample < 40; ++sample) {
        const dvec3 q = sample == 0 ? middle : point(p);
        bool inside = true;
        for (int k = 0; k < 3; ++k) inside &= box.lo[k] <= q[k] && q[k] <= box.hi[k];
        if (!inside) continue;
        ++n_inside;
        for (int k = 0; k < 3; ++k) {
          ASSERT_LE(found.lo[k] - kRounding, q[k]);
          ASSERT_GE(found.hi[k] + kRounding, q[k]);
        }
      }
    }
  }
  EXPECT_GT(n_inside, 1000);
}

template <class Kind>
class ClipOf : public testing::Test {};
TYPED_TEST_SUITE(ClipOf, AllShapes, KindNames);

TYPED_TEST(ClipOf, ContainsItsPoints) {
  constexpr std::uint64_t kSeed = 7;
  SCOPED_TRACE(kSeed);
  Random random(kSeed);
  scene::Geometry g;
  add_primitives(TypeParam(), g, random, 400, 3);
  check_samples<TypeParam>(g, random);
}

TEST(Rounding, IsOutward) {
  for (const double x : {1.0 + 1e-12, -1.0 - 1e-12, 1e-60, -1e-60, 0.1, -0.1, 0.0, 16777217.0}) {
    EXPECT_LE(round_down(x), x);
    EXPECT_GE(round_up(x), x);
    EXPECT_GT(std::nextafter(round_down(x), INFINITY), x);
    EXPECT_LT(std::nextafter(round_up(x), -INFINITY), x);
  }
}

}  // namespace
}  // namespace kdray::test
