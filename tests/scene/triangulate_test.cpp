#include "scene/model/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "scene/import/load.h"
#include "scene/model/predicates.h"

namespace kdray::scene {
namespace {

using Triples = std::vector<std::array<std::uint32_t, 3>>;
constexpr double kPi = 3.14159265358979323846;

dvec3 area_of(const std::vector<dvec3>& p, const std::array<std::uint32_t, 3>& t) {
  return 0.5 * glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
}

dvec3 area_of(const std::vector<dvec3>& p) {
  dvec3 sum(0);
  for (std::size_t i = 1; i + 1 < p.size(); ++i) sum += 0.5 * glm::cross(p[i] - p[0], p[i + 1] - p[0]);
  return sum;
}

// A triangulation of a simple polygon: n - 2 triangles of distinct corners, all turned as the polygon is,
// whose areas add up to its own. (Turned alike and of the right total, they cannot overlap or leave a gap.)
void expect_cover(const std::vector<dvec3>& p, bool without_flat = true) {
  const Triples triangles = triangulate(p);
  ASSERT_EQ(triangles.size(), p.size() - 2);
  const dvec3 whole = area_of(p);
  const double size = glm::length(whole);
  double sum = 0;
  for (const auto& t : triangles) {
    for (const auto corner : t) ASSERT_LT(corner, p.size());
    const double part = glm::dot(area_of(p, t), whole) / size;
    sum += part;
    EXPECT_GE(part, -1e-12 * size);
    if (without_flat) {
      EXPECT_GT(part, 0);
    }
  }
  EXPECT_NEAR(sum, size, 1e-9 * size);
}

std::vector<dvec3> turned(std::vector<dvec3> p, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const dvec3 w = glm::normalize(dvec3(normal(random), normal(random), normal(random)));
  const dvec3 u = glm::normalize(glm::cross(w, std::abs(w.x) < 0.5 ? dvec3(1, 0, 0) : dvec3(0, 1, 0)));
  const dvec3 v = glm::cross(w, u);
  for (dvec3& q : p) q = q.x * u + q.y * v + q.z * w;
  return p;
}

TEST(Triangulate, LeavesATriangleAlone) {
  EXPECT_EQ(triangulate(std::vector<dvec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), (Triples{{0, 1, 2}}));
  EXPECT_EQ(triangulate(std::vector<dvec3>(3, dvec3(1))), (Triples{{0, 1, 2}})) << "even one without area";
  EXPECT_TRUE(triangulate(std::vector<dvec3>(2, dvec3(1))).empty());
  EXPECT_TRUE(triangulate({}).empty());
}

TEST(Triangulate, MakesTheFanOfAConvexPolygon) {
  const std::vector<dvec3> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  EXPECT_EQ(triangulate(square), (Triples{{0, 1, 2}, {0, 2, 3}}));
  std::vector<dvec3> circle;
  for (int i = 0; i < 100; ++i) circle.push_back({std::cos(i * kPi / 50), 5, std::sin(i * kPi / 50)});
  const Triples triangles = triangulate(circle);
  ASSERT_EQ(triangles.size(), 98u);
  for (std::uint32_t i = 0; i < 98; ++i)
    EXPECT_EQ(triangles[i], (std::array<std::uint32_t, 3>{0, i + 1, i + 2}));
}

TEST(Triangulate, CutsADartThroughItsNotch) {
  // Corner 0 does not see corner 2's far side: the fan of corner 1 or 3 is the only way.
  EXPECT_NO_FATAL_FAILURE(expect_cover({{0, 0, 0}, {4, -2, 0}, {1, 0, 0}, {4, 2, 0}}));
  EXPECT_NO_FATAL_FAILURE(expect_cover({{4, 2, 0}, {0, 0, 0}, {4, -2, 0}, {1, 0, 0}}));
}

TEST(Triangulate, CoversStarShapedPolygonsInAnyPlaneAndBothWaysRound) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> radius(0.05, 1), turn(0.1, 1);
    const int n = 4 + static_cast<int>(random() % 60);
    std::vector<double> angle(static_cast<std::size_t>(n));
    double sum = 0;
    for (double& a : angle) a = (sum += turn(random));
    std::vector<dvec3> p;
    for (const double a : angle) {
      const double phi = a / sum * 2 * kPi;
      const double r = radius(random);
      p.push_back({r * std::cos(phi), r * std::sin(phi), 3});
    }
    if (seed % 2) std::reverse(p.begin(), p.end());
    EXPECT_NO_FATAL_FAILURE(expect_cover(turned(p, random)));
  }
}

TEST(Triangulate, CoversCombsAndSpirals) {
  std::vector<dvec3> comb;
  for (int i = 0; i < 200; ++i) comb.push_back({i, i % 2 ? 10 : 0.5, 0});
  comb.push_back({199, -1, 0});
  comb.push_back({0, -1, 0});
  EXPECT_NO_FATAL_FAILURE(expect_cover(comb));
  std::vector<dvec3> spiral;
  for (int i = 0; i <= 300; ++i)
    spiral.push_back({(1 + i) * std::cos(i * 0.2), (1 + i) * std::sin(i * 0.2), 0});
  for (int i = 300; i >= 0; --i)
    spiral.push_back({(1.5 + i) * std::cos(i * 0.2), (1.5 + i) * std::sin(i * 0.2), 0});
  EXPECT_NO_FATAL_FAILURE(expect_cover(spiral));
}

// A corner on a straight edge belongs to a neighbour's edge too; a flat triangle there would be dropped later
// and leave a crack.
TEST(Triangulate, MakesNoFlatTriangleOfCornersOnAStraightLine) {
  std::vector<dvec3> square;
  for (int i = 0; i < 8; ++i) square.push_back({i, 0, 0});
  for (int i = 0; i < 8; ++i) square.push_back({8, i, 0});
  for (int i = 0; i < 8; ++i) square.push_back({8 - i, 8, 0});
  for (int i = 0; i < 8; ++i) square.push_back({0, 8 - i, 0});
  for (std::size_t shift = 0; shift < square.size(); ++shift) {
    SCOPED_TRACE(shift);
    std::rotate(square.begin(), square.begin() + 1, square.end());
    EXPECT_NO_FATAL_FAILURE(expect_cover(square));
  }
}

TEST(Triangulate, TakesRepeatedCornersAndBridgesToHoles) {
  EXPECT_NO_FATAL_FAILURE(
      expect_cover({{0, 0, 0}, {0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {4, 4, 0}, {1, 1, 0}}, false));
  // A square with a square hole, joined by a bridge that is walked twice.
  EXPECT_NO_FATAL_FAILURE(expect_cover({{0, 0, 0},
                                        {9, 0, 0},
                                        {9, 9, 0},
                                        {0, 9, 0},
                                        {0, 0, 0},
                                        {3, 3, 0},
                                        {3, 6, 0},
                                        {6, 6, 0},
                                        {6, 3, 0},
                                        {3, 3, 0}}));
}

TEST(Triangulate, GivesAnswersForWhatIsNoSimplePolygon) {
  const auto count = [](const std::vector<dvec3>& p) { return triangulate(p).size(); };
  EXPECT_EQ(count(std::vector<dvec3>(7, dvec3(1))), 5u);                               // a point
  EXPECT_EQ(count({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}), 2u);                  // a line
  EXPECT_EQ(count({{0, 0, 0}, {4, 4, 0}, {4, 0, 0}, {0, 3, 0}}), 2u);                  // a bow tie
  EXPECT_EQ(count({{0, 0, 0}, {1e200, 0, 0}, {1e200, 1e200, 0}, {0, 1e200, 0}}), 2u);  // overflow
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    std::vector<dvec3> p(4 + random() % 40);
    for (dvec3& q : p) q = dvec3(random() % 5, random() % 5, 0);  // crossing, touching, repeating
    EXPECT_EQ(count(p), p.size() - 2) << "seed " << seed;
  }
}

// A second; quadratic work would take longer than CTest waits.
TEST(Triangulate, DoesNotHangOnHugePolygons) {
  std::vector<dvec3> star, mess;
  std::mt19937 random(1);
  for (int i = 0; i < 100'000; ++i) {
    const double phi = i * 2 * kPi / 100'000;
    const double r = i % 2 ? 1.0 : 0.999;
    star.push_back({r * std::cos(phi), r * std::sin(phi), 0});
    if (i < 20'000) mess.push_back({random() % 1000 * 1.0, random() % 1000 * 1.0, 0});
  }
  EXPECT_NO_FATAL_FAILURE(expect_cover(star));
  bool finished = true;
  EXPECT_EQ(triangulate(mess, &finished).size(), mess.size() - 2);
  EXPECT_FALSE(finished);
}

// Long ears side by side: all corners of a comb lie between any two x of one of its ears, or between any two
// y.
TEST(Triangulate, CoversCombsOfAHundredThousandCorners) {
  for (const bool lying : {false, true}) {
    SCOPED_TRACE(lying);
    std::vector<dvec3> comb;
    constexpr int kTeeth = 60'000;
    for (int i = 0; i < 2 * kTeeth; ++i) comb.push_back({i, i % 2 ? 1e6 : 0.5 + 0.25 * (i % 3), 0});
    comb.push_back({2 * kTeeth - 1.0, -1, 0});
    comb.push_back({0, -1, 0});
    if (lying)
      for (dvec3& p : comb) std::swap(p.x, p.y);
    bool finished = false;
    const Triples triangles = triangulate(comb, &finished);
    EXPECT_TRUE(finished);
    EXPECT_NO_FATAL_FAILURE(expect_cover(comb));
  }
}

// A spiral has two ears at a time: whoever goes round to find them takes n^2 steps.
TEST(Triangulate, CoversASpiralOfAHundredThousandCorners) {
  constexpr int kSteps = 60'000;
  std::vector<dvec3> spiral;
  const auto at = [](int i, double more) {
    return dvec3((1 + 0.01 * i + more) * std::cos(i * 0.02), (1 + 0.01 * i + more) * std::sin(i * 0.02), 0);
  };
  for (int i = 0; i <= kSteps; ++i) spiral.push_back(at(i, 0));
  for (int i = kSteps; i >= 0; --i) spiral.push_back(at(i, 0.5));
  bool finished = false;
  (void)triangulate(spiral, &finished);
  EXPECT_TRUE(finished);
  EXPECT_NO_FATAL_FAILURE(expect_cover(spiral));
}

// Of a file, whose line is told.
TEST(Triangulate, SaysWhenItGaveUp) {
  constexpr int kCorners = 20'000;
  std::string corners = "# a mess\n", face = "f";
  std::mt19937 random(1);
  for (int i = 1; i <= kCorners; ++i) {
    const auto x = random() % 1000, y = random() % 1000;
    corners += "v " + std::to_string(x) + " " + std::to_string(y) + " 0\n";
    face += " " + std::to_string(i);
  }
  const Scene scene = read_obj(corners + face + "\n", "a.obj");
  EXPECT_EQ(scene.triangles.size(), std::size_t{kCorners} - 2);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(
      scene.warnings[0],
      "a.obj:20002: a polygon of 20000 corners crosses itself too often to be cut up: part of it is a fan");
}

TEST(OrientSign, IsExactWhereRoundingDecides) {
  // Points along a line through (0.5, 0.5) moved by single ulps: the sign follows from integers. (Kettner et
  // al. 2008)
  const double ulp = 0x1p-53;
  for (int i = 0; i < 64; ++i) {
    for (int j = 0; j < 64; ++j) {
      const dvec2 a(0.5 + i * ulp, 0.5 + j * ulp);
      // (b - a) x (c - a) with b = (12, 12), c = (24, 24) is 12 * (a.y - a.x).
      const int want = (j > i) - (j < i);
      EXPECT_EQ(orient_sign(a, {12, 12}, {24, 24}), want) << i << " " << j;
      EXPECT_EQ(orient_sign({12, 12}, {24, 24}, a), want) << i << " " << j;
      EXPECT_EQ(orient_sign({24, 24}, {12, 12}, a), -want) << i << " " << j;
    }
  }
}

}  // namespace
}  // namespace kdray::scene
