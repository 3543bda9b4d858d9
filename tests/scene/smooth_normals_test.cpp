// Normals from neighbours, against surfaces whose normals are known.
#include "scene/model/normals.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kdray::scene {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Every triangle brings its own corners, as in an STL file.
void add(Scene& s, const dvec3& a, const dvec3& b, const dvec3& c) {
  const auto first = static_cast<std::uint32_t>(s.vertices.size());
  for (const dvec3& p : {a, b, c}) s.vertices.push_back(p);
  s.triangles.push_back({.vertex = {first, first + 1, first + 2}, .number = first / 3});
}

Scene cube(double size) {
  Scene s;
  const auto corner = [size](int i) { return size * dvec3(i & 1, i >> 1 & 1, i >> 2); };
  for (const auto& f : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                        std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}}) {
    add(s, corner(f[0]), corner(f[1]), corner(f[2]));
    add(s, corner(f[0]), corner(f[2]), corner(f[3]));
  }
  return s;
}

dvec3 normal(const Scene& s, std::size_t triangle, std::size_t k) {
  return dvec3(s.normals[s.triangles[triangle].normal[k]]);
}

TEST(SmoothNormals, KeepSharpEdgesAndRoundOthers) {
  for (const double size : {1e-200, 1.0, 1e200}) {
    SCOPED_TRACE(size);
    Scene sharp = cube(size), round = cube(size);
    smooth_normals(sharp, 30);
    smooth_normals(round, 100);
    EXPECT_EQ(sharp.normals.size(), 24u) << "one for each face at each of eight corners";
    EXPECT_EQ(round.normals.size(), 8u) << "one at each corner";
    for (std::size_t t = 0; t < 12; ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const dvec3 flat = normal(sharp, t, k);
        EXPECT_EQ(std::abs(flat.x) + std::abs(flat.y) + std::abs(flat.z), 1) << "along an axis";
        // By angles, each face counts alike, whether one or two of its triangles meet there.
        const dvec3 away = (round.vertices[round.triangles[t].vertex[k]] / size - 0.5) / std::sqrt(0.75);
        EXPECT_LT(glm::length(normal(round, t, k) - away), 1e-6);
      }
  }
}

TEST(SmoothNormals, OfABallPointAwayFromItsMiddle) {
  Scene s;
  constexpr int kRows = 40;
  const auto at = [](int i, int j) {
    const double u = kPi * i / kRows, v = kPi * (j % (2 * kRows)) / kRows;
    return i == 0 || i == kRows ? dvec3(0, 0, i == 0 ? 1 : -1)
                                : dvec3(std::sin(u) * std::cos(v), std::sin(u) * std::sin(v), std::cos(u));
  };
  for (int i = 0; i < kRows; ++i)
    for (int j = 0; j < 2 * kRows; ++j) {
      if (i + 1 < kRows) add(s, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      if (i > 0) add(s, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  smooth_normals(s, 30);
  for (std::size_t t = 0; t < s.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LT(glm::length(normal(s, t, k) - s.vertices[s.triangles[t].vertex[k]]), 0.02);
}

// A triangle without area takes part in whatever is at its corners, though it turns against all of that;
// where there is nothing but its like, it stays without.
TEST(SmoothNormals, OfATriangleWithoutAreaAreItsNeighbours) {
  Scene s;
  add(s, {0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  add(s, {1, 0, 0}, {0, 0, 0}, {0, -4, 0});
  add(s, {4, 0, 0}, {1, 0, 0}, {0, -4, 0});
  add(s, {0, 0, 0}, {1, 0, 0}, {4, 0, 0});
  add(s, {0.1, 9, 0.1}, {0.2, 9, 0.2}, {0.3, 9, 0.3});
  smooth_normals(s, 20);
  for (std::size_t t = 0; t < 4; ++t)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(normal(s, t, k), dvec3(0, 0, 1));
  EXPECT_EQ(s.triangles[4].normal, (std::array<std::uint32_t, 3>{kNone, kNone, kNone}));
}

TEST(SmoothNormals, LeaveThoseOfTheFileAlone) {
  Scene s = cube(1);
  s.normals = {vec3(0, 0, 1)};
  s.triangles[3].normal = {0, 0, 0};
  smooth_normals(s, 100);
  EXPECT_EQ(s.triangles[3].normal, (std::array<std::uint32_t, 3>{0, 0, 0}));
  EXPECT_EQ(s.normals[0], vec3(0, 0, 1));
  EXPECT_NE(s.triangles[2].normal[0], kNone);
}

}  // namespace
}  // namespace kdray::scene
