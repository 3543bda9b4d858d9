// The bound on |n|_1 that a triangle's lane has: never below what the kernels compute in floats, at any
// scale, and hardly above it.
#include "accel/flatten/wide.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "accel/flatten/lanes.h"
#include "accel/kdtree/build.h"
#include "accel/kdtree/shapes.h"

namespace kdray::flatten {
namespace {

using test::Random;

constexpr std::uint64_t kSeed = 71;

float diff_of_products(float a, float b, float c, float d) {
  const float w = c * d;
  return std::fma(a, b, -w) + std::fma(-c, d, w);
}

// The normal is computed as sign_limit in kernels/primitives/triangle/intersect.clh does it.
float normal_in_float(const layout::Triangle& t) {
  float e[3], f[3];
  for (int k = 0; k < 3; ++k) {
    e[k] = t.v[1][k] - t.v[0][k];
    f[k] = t.v[2][k] - t.v[0][k];
  }
  const float x = std::abs(diff_of_products(e[1], f[2], e[2], f[1]));
  const float y = std::abs(diff_of_products(e[2], f[0], e[0], f[2]));
  const float z = std::abs(diff_of_products(e[0], f[1], e[1], f[0]));
  float edge = 0;
  for (int k = 0; k < 3; ++k) edge = std::max({edge, std::abs(e[k]), std::abs(f[k])});
  return x + y + z + 8 * edge * edge;  // with the largest tilt
}

// Triangles of all shapes in a leaf: general ones, needles, ones without area but for rounding; at any place.
FlatScene shapes_at_scale(Random& random, float scale, int n) {
  FlatScene flat;
  flat.triangles = Array<layout::Triangle>(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    const vec3 place = static_cast<float>(i % 3) * 30.0f * test::random_vec3(random, -1, 1);
    const vec3 edge = test::random_vec3(random, -1, 1);
    vec3 other = test::random_vec3(random, -1, 1);
    if (i % 4 == 1) other = edge + 1e-3f * other;
    if (i % 4 == 2) other = test::uniform(random, -1, 1) * edge;
    if (i % 4 == 3) other = 1e-6f * other;
    layout::Triangle t{};
    const vec3 corner[3] = {place, place + edge, place + other};
    for (int v = 0; v < 3; ++v)
      for (int k = 0; k < 3; ++k) t.v[v][k] = scale * corner[v][k];
    flat.triangles[static_cast<std::size_t>(i)] = t;
  }
  return flat;
}

kdtree::Tree leaf_of_triangles(u32 n) {
  kdtree::Tree tree;
  tree.nodes = {{.left = 0, .right = n}};
  tree.contents = {{vec3(0), vec3(1)}};  // any that is not empty
  for (u32 i = 0; i < n; ++i) tree.refs.push_back(kdtree::make_ref(scene::PrimitiveKind::triangle, i));
  return tree;
}

void expect_normal_bounds(const FlatScene& flat) {
  const auto n = static_cast<u32>(flat.triangles.size());
  const WideForm wide = make_wide(leaf_of_triangles(n), flat, 8);
  for (u32 i = 0; i < n; ++i)
    ASSERT_GE(std::abs(Lane(wide, 0, i).number(9)), normal_in_float(flat.triangles[i])) << "triangle " << i;
}

TEST(NormalBound, IsNotBelowWhatFloatsGive) {
  Random random(kSeed + 2);
  for (const float scale : {1.0f, 1e-3f, 1e5f, 0x1p50f, 0x1p60f, 0x1p-40f, 0x1p-55f}) {
    SCOPED_TRACE(scale);
    expect_normal_bounds(shapes_at_scale(random, scale, 20000));
    if (HasFatalFailure()) return;
  }
}

// Among others in a block, and alone in a plane across an axis.
TEST(NormalBound, OfAZeroAreaTriangleIsInfinite) {
  Random random(kSeed + 5);
  FlatScene flat = shapes_at_scale(random, 1, 20);
  for (layout::Triangle& t : flat.triangles) t.normals = KDRAY_NO_NORMALS;
  for (const std::size_t i : {3u, 9u, 19u}) {
    flat.triangles[i].normals = KDRAY_ZERO_AREA | 7u;
    for (auto& corner : flat.triangles[i].v) corner[0] = 5;
  }
  const WideForm wide = make_wide(leaf_of_triangles(20), flat, 8);
  for (u32 i = 0; i < 20; ++i) {
    const bool zero_area = i == 3 || i == 9 || i == 19;
    EXPECT_EQ(Lane(wide, 0, i).number(9) == INFINITY, zero_area) << i;
  }
}

// There errors have a least size instead of a relative one.
TEST(NormalBound, HoldsWhereProductsUnderflow) {
  Random random(kSeed + 3);
  for (const float scale : {0x1p-65f, 0x1p-70f, 0x1p-73f, 0x1p-74f, 0x1p-75f, 0x1p-80f, 0x1p-120f}) {
    SCOPED_TRACE(scale);
    expect_normal_bounds(shapes_at_scale(random, scale, 20000));
    if (HasFatalFailure()) return;
  }
  // The smallest that was found: |n|_1 is 2^-147 + 2^-148 in float.
  FlatScene flat;
  flat.triangles = Array<layout::Triangle>::copy_of(std::vector<layout::Triangle>(1));
  const float corner[2][3] = {{2, 0, 2}, {2, 3, 3}};
  for (int v = 0; v < 2; ++v)
    for (int k = 0; k < 3; ++k) flat.triangles[0].v[v + 1][k] = 0x1p-76f * corner[v][k];
  expect_normal_bounds(flat);
}

// Near the truth too: a loose bound would send every ray to the slow decision on the sign of t.
TEST(NormalBound, IsTight) {
  Random random(kSeed + 4);
  const FlatScene flat = shapes_at_scale(random, 1, 20000);
  const WideForm wide = make_wide(leaf_of_triangles(20000), flat, 8);
  int n_loose = 0;
  for (std::size_t i = 0; i < flat.triangles.size(); i += 4)  // those of no odd shape
    n_loose += std::abs(Lane(wide, 0, i).number(9)) > 1.001f * normal_in_float(flat.triangles[i]);
  EXPECT_LT(n_loose, 50);
}

}  // namespace
}  // namespace kdray::flatten
