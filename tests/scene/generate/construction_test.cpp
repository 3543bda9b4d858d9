// What    Each scene against the geometry it is built on, without reference files.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "nff_lines.h"

namespace kdray::generate {
namespace {

using test::generated;
using test::Nff;
using test::NffPolygon;
using test::parse_nff;

using Point = std::array<double, 3>;
using Edge = std::pair<Point, Point>;

Point key(const dvec3& v) {
  return {v.x, v.y, v.z};
}

// How often each directed edge occurs.
std::map<Edge, int> directed_edges(const std::vector<NffPolygon>& polygons, std::size_t first,
                                   std::size_t last) {
  std::map<Edge, int> edges;
  for (std::size_t i = first; i < last; ++i) {
    const auto& v = polygons[i].vertices;
    for (std::size_t k = 0; k < v.size(); ++k) ++edges[{key(v[k]), key(v[(k + 1) % v.size()])}];
  }
  return edges;
}

TEST(Balls, EachTouchesItsParent) {
  const Nff nff = parse_nff(generated("balls", 3));
  std::array<test::NffSphere, 4> last{};  // at each level, in preorder the parent of what follows
  for (const test::NffSphere& s : nff.spheres) {
    const auto level = static_cast<std::size_t>(std::lround(std::log(0.5 / s.radius) / std::log(3.0)));
    ASSERT_LT(level, last.size());
    EXPECT_NEAR(s.radius, 0.5 / std::pow(3, double(level)), 1e-9);
    if (level > 0) {
      const test::NffSphere& parent = last[level - 1];
      EXPECT_NEAR(glm::distance(s.center, parent.center), s.radius + parent.radius, 1e-8);
    }
    last[level] = s;
  }
}

TEST(Gears, AreClosedAndOriented) {
  const Nff nff = parse_nff(generated("gears", 2));
  for (std::size_t gear = 0; gear < 8; ++gear) {
    const auto edges = directed_edges(nff.polygons, 1 + gear * 146, 1 + (gear + 1) * 146);
    EXPECT_EQ(edges.size(), 3u * 144 * 2);
    // The lower face is computed by turning the other way, so its vertices may differ in the last digit
    // printed.
    int unmatched = 0;
    for (const auto& entry : edges) {
      const Edge& edge = entry.first;
      EXPECT_EQ(entry.second, 1);
      const bool matched = std::ranges::any_of(edges, [&](const auto& other) {
        const auto near = [](const Point& a, const Point& b) {
          return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]) < 1e-8;
        };
        return near(other.first.first, edge.second) && near(other.first.second, edge.first);
      });
      unmatched += !matched;
    }
    EXPECT_EQ(unmatched, 0) << "gear " << gear;
  }
}

TEST(Jacks, ArmsAreOrthogonalAndEndInBalls) {
  const Nff nff = parse_nff(generated("jacks", 2));
  for (std::size_t jack = 0; jack < 9; ++jack) {
    std::array<dvec3, 3> arms;
    for (std::size_t i = 0; i < 3; ++i) {
      const test::NffCone& c = nff.cones[3 * jack + i];
      arms[i] = (c.apex - c.base) / 2.0;
      EXPECT_NEAR(glm::length(arms[i]), jack == 0 ? 0.75 : 0.375, 1e-8);
      EXPECT_LT(glm::distance(nff.spheres[6 * jack + i].center, c.apex), 1e-8);
      EXPECT_LT(glm::distance(nff.spheres[6 * jack + i + 3].center, c.base), 1e-8);
    }
    EXPECT_NEAR(glm::dot(glm::cross(arms[0], arms[1]), arms[2]), std::pow(glm::length(arms[0]), 3), 1e-8);
  }
}

TEST(Lattice, RodsReachFromBallToNextBall) {
  const Nff nff = parse_nff(generated("lattice", 3));
  std::map<std::array<long, 3>, double> balls;
  const auto place = [](const dvec3& p) {
    return std::array<long, 3>{std::lround(p.x * 3), std::lround(p.y * 3), std::lround(p.z * 3)};
  };
  for (const test::NffSphere& s : nff.spheres) balls[place(s.center)] = s.radius;
  EXPECT_EQ(balls.size(), 64u);
  for (const test::NffCone& c : nff.cones) {
    ASSERT_TRUE(balls.contains(place(c.base)) && balls.contains(place(c.apex)));
    EXPECT_NE(place(c.base), place(c.apex));
    for (const dvec3& end : {c.base, c.apex}) {
      const dvec3 ball = dvec3(place(end)[0], place(end)[1], place(end)[2]) / 3.0;
      EXPECT_LT(std::hypot(glm::distance(end, ball), c.base_radius), balls[place(end)]) << "a rim shows";
    }
  }
}

// Every inner edge belongs to two triangles that run along it in opposite directions: a sheet without cracks.
void expect_sheet(const std::vector<NffPolygon>& triangles, std::size_t boundary) {
  const auto edges = directed_edges(triangles, 0, triangles.size());
  EXPECT_EQ(edges.size(), 3 * triangles.size());
  std::size_t open = 0;
  for (const auto& [edge, count] : edges) open += !edges.contains({edge.second, edge.first});
  EXPECT_EQ(open, boundary);
}

TEST(Mount, HasNoCracks) {
  expect_sheet(parse_nff(generated("mount", 5)).polygons, 4 * 32);
}
TEST(Sombrero, HasNoCracks) {
  expect_sheet(parse_nff(generated("sombrero", 1)).polygons, 4 * 31);
}

TEST(Mount, SpheresFormAPyramid) {
  const Nff nff = parse_nff(generated("mount", 1));
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_NEAR(glm::distance(nff.spheres[i].center, nff.spheres[k].center), 2 * 0.17, 1e-8)
          << "don't touch";
}

TEST(Rings, JointsLieOnTheirSphereAndRodsAreEqual) {
  const Nff nff = parse_nff(generated("rings", 1));
  const dvec3 center{0, 1 / std::sin(std::numbers::pi / 8), 0};
  const double radius = 1 / (1 + 0.07412);
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_NEAR(glm::distance(nff.spheres[i].center, center), radius, 1e-8);
    EXPECT_NEAR(glm::distance(nff.cones[i].base, nff.cones[i].apex),
                2 * radius * std::sin(std::numbers::pi / 5), 1e-8);
    EXPECT_EQ(nff.cones[i].base, nff.spheres[i].center);
  }
}

TEST(Shells, SpheresGrowAlongTheSpiral) {
  const Nff nff = parse_nff(generated("shells", 2));
  for (std::size_t i = 1; i < nff.spheres.size(); ++i) {
    EXPECT_GT(nff.spheres[i].radius, nff.spheres[i - 1].radius);
    EXPECT_NEAR(nff.spheres[i].center.z, -2 * nff.spheres[i].radius, 1e-6);
    EXPECT_LT(glm::distance(nff.spheres[i].center, nff.spheres[i - 1].center), nff.spheres[i].radius) << i;
  }
  EXPECT_NEAR(nff.spheres[480].radius, 1, 1e-12);  // where two thirds of the steps are done
}

TEST(Tetra, KeepsTheAreaOfTheWhole) {
  for (const int size : {1, 3, 5}) {
    double area = 0;
    dvec3 sum(0);  // of a closed surface's area vectors
    for (const NffPolygon& p : parse_nff(generated("tetra", size)).polygons) {
      const dvec3 normal = glm::cross(p.vertices[1] - p.vertices[0], p.vertices[2] - p.vertices[0]) / 2.0;
      area += glm::length(normal);
      sum += normal;
    }
    EXPECT_NEAR(area, 8 * std::sqrt(3.0), 1e-8) << size;
    EXPECT_LT(glm::length(sum), 1e-10) << size;
  }
}

TEST(Tree, BranchesGrowFromTheSpheresOfOthers) {
  const Nff nff = parse_nff(generated("tree", 5));
  std::map<Point, double> ends{{{0, 0, 0}, 0.15}};
  std::map<Point, int> children;
  for (std::size_t i = 0; i < nff.cones.size(); ++i) {
    const test::NffCone& c = nff.cones[i];
    ASSERT_TRUE(ends.contains(key(c.base))) << "branch " << i << " hangs in the air";
    EXPECT_EQ(c.base_radius, ends[key(c.base)]);
    EXPECT_NEAR(c.apex_radius, 0.67 * c.base_radius, 1e-9);
    EXPECT_EQ(nff.spheres[i].center, c.apex);
    EXPECT_EQ(nff.spheres[i].radius, c.apex_radius);
    ends[key(c.apex)] = c.apex_radius;
    ++children[key(c.base)];
  }
  EXPECT_EQ(children.at({0, 0, 0}), 1);
  for (const auto& [base, count] : children) {
    EXPECT_TRUE(count == 2 || base == (Point{0, 0, 0})) << count;
  }
}

TEST(Teapot, NormalsAreUnitAndStandOnTheTriangles) {
  for (const int size : {2, 5, 12}) {
    const Nff nff = parse_nff(generated("teapot", size));
    for (const NffPolygon& p : nff.patches) {
      const dvec3 area = glm::cross(p.vertices[1] - p.vertices[0], p.vertices[2] - p.vertices[0]);
      EXPECT_GT(glm::length(area), 1e-9) << "a triangle without area";
      for (const dvec3& n : p.normals) EXPECT_NEAR(glm::length(n), 1, 1e-7);
      // Coarse triangles lie at an angle to the surface they stand for.
      if (size < 12) continue;
      EXPECT_GT(std::abs(glm::dot(glm::normalize(area), glm::normalize(p.normals[1]))), 0.5);
    }
  }
}

TEST(Teapot, IsSymmetricInY) {
  const Nff nff = parse_nff(generated("teapot", 4));
  std::map<std::array<long, 3>, int> balance;
  for (const NffPolygon& p : nff.patches)
    for (const dvec3& v : p.vertices) {
      const auto at = [&](double y) {
        return std::array<long, 3>{std::lround(v.x * 1e6), std::lround(y * 1e6), std::lround(v.z * 1e6)};
      };
      balance[at(v.y)] |= 1;
      balance[at(-v.y)] |= 2;
    }
  for (const auto& [place, seen] : balance)
    EXPECT_EQ(seen, 3) << place[0] << ' ' << place[1] << ' ' << place[2];
}

}  // namespace
}  // namespace kdray::generate
