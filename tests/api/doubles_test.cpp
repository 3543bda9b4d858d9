// Rays and points of doubles near surfaces, where floats can't tell the sides apart: against exact rational
// arithmetic, and against shapes' own formulas.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "api/rationals.h"
#include "kdray/kdray.h"
#include "support/device.h"
#include "support/errors.h"
#include "support/meshes.h"

namespace kdray {
namespace {

using test::Cube;
using test::Exact;
using test::exact;
using test::fails;
using test::minus;
using test::Point;
using test::volume;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr unsigned kSeed = 39;

class Doubles : public test::EachDevice {
 protected:
  CommitOptions options() const {
    CommitOptions options;
    options.device.device = GetParam();
    return options;
  }
  template <class Vertices>
  Scene scene_of(const Vertices& vertices, const std::vector<std::uint32_t>& triangles) const {
    Scene scene;
    scene.add_mesh({vertices, triangles});
    scene.commit(options());
    return scene;
  }
};
KDRAY_FOR_EACH_DEVICE(Doubles);

// Floats about the origin, which scenes keep as they are.
struct Mesh {
  std::vector<float> vertices;
  std::vector<std::uint32_t> triangles;

  Point corner(std::size_t triangle, std::size_t i) const {
    const float* v = &vertices[3 * triangles[3 * triangle + i]];
    return {v[0], v[1], v[2]};
  }
  std::size_t size() const { return triangles.size() / 3; }
};

Mesh cube() {
  const Cube cube;
  return {cube.vertices, cube.triangles};
}

// Of odd floats, so that no plane is exact in any other arithmetic than the rationals'.
Mesh torus(std::uint32_t n, std::uint32_t m, std::mt19937& random) {
  std::uniform_real_distribution<float> shaken(-0.01f, 0.01f);
  Mesh mesh;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < m; ++k) {
      const float a = 6.2831853f * static_cast<float>(i) / static_cast<float>(n),
                  b = 6.2831853f * static_cast<float>(k) / static_cast<float>(m);
      const float r = 0.7f + 0.25f * std::cos(b);
      for (const float x : {r * std::cos(a), r * std::sin(a), 0.25f * std::sin(b)})
        mesh.vertices.push_back(x + shaken(random));
      const std::uint32_t next_i = (i + 1) % n, next_k = (k + 1) % m;
      const std::uint32_t p = i * m + k, q = next_i * m + k, r2 = next_i * m + next_k, s = i * m + next_k;
      for (const std::uint32_t v : {p, q, r2, p, r2, s}) mesh.triangles.push_back(v);
    }
  return mesh;
}

// Two cubes, one turned, that overlap: an odd number of them holds what is inside.
Mesh overlapping_cubes() {
  Mesh mesh = cube();
  const Cube other;
  for (std::size_t i = 0; i < other.vertices.size(); i += 3) {
    const float x = other.vertices[i], y = other.vertices[i + 1], z = other.vertices[i + 2];
    for (const float v : {0.61f * x - 0.37f * y + 0.5f, 0.37f * x + 0.61f * y + 0.3f, 0.7f * z + 0.1f * x})
      mesh.vertices.push_back(v);
  }
  for (const std::uint32_t v : other.triangles) mesh.triangles.push_back(8 + v);
  return mesh;
}

// t of all that the half-line crosses, exactly; none where it meets an edge or begins in a plane.
std::optional<std::vector<mpq_class>> crossed(const Mesh& mesh, const Point& origin, const Point& direction) {
  const Exact o = exact(origin), d = exact(direction);
  std::vector<mpq_class> found;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    Exact v[3];
    for (std::size_t k = 0; k < 3; ++k) v[k] = minus(exact(mesh.corner(i, k)), o);
    mpq_class w[3];
    int above = 0;
    for (int k = 0; k < 3; ++k) {
      w[k] = volume(v[(k + 1) % 3], v[(k + 2) % 3], d);
      if (w[k] == 0) return std::nullopt;
      above += sgn(w[k]);
    }
    if (above != 3 && above != -3) continue;
    const mpq_class t = volume(v[0], v[1], v[2]) / (w[0] + w[1] + w[2]);
    if (t == 0) return std::nullopt;
    if (t > 0) found.push_back(t);
  }
  std::sort(found.begin(), found.end());
  return found;
}

// By any direction in which nothing is met at an edge.
bool is_inside(const Mesh& mesh, const Point& point, std::mt19937& random) {
  std::uniform_real_distribution<double> anywhere(-1, 1);
  for (;;)
    if (const auto t = crossed(mesh, point, {anywhere(random), anywhere(random), anywhere(random)}))
      return t->size() % 2 == 1;
}

// 1e-9 to 1e-6 beside a face, an edge or a vertex.
Point near_surface(const Mesh& mesh, std::mt19937& random) {
  std::uniform_real_distribution<double> share(0, 1), way(-1, 1), size(-9, -6);
  const std::size_t triangle = random() % mesh.size(), kind = random() % 3;
  double u = share(random), v = share(random) * (1 - u);
  if (kind > 0) v = 0;
  if (kind > 1) u = 0;
  const Point a = mesh.corner(triangle, 0), b = mesh.corner(triangle, 1), c = mesh.corner(triangle, 2);
  const double off = std::pow(10.0, size(random));
  Point p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]) + off * way(random);
  return p;
}

TEST_P(Doubles, PointsNearFacesEdgesAndVerticesAreOnTheirSide) {
  std::mt19937 random(kSeed);
  for (const Mesh& mesh : {cube(), overlapping_cubes(), torus(11, 7, random)}) {
    const Scene scene = scene_of(mesh.vertices, mesh.triangles);
    std::vector<Point> points(1500);
    for (Point& p : points) p = near_surface(mesh, random);
    const Points given(&points.front()[0], points.size(), sizeof(Point));
    std::vector<std::uint8_t> inside(points.size());
    std::vector<double> distance(points.size());
    scene.inside(given, inside);
    scene.signed_distance(given, distance);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool expected = is_inside(mesh, points[i], random);
      ASSERT_EQ(inside[i] != 0, expected) << "seed " << kSeed << ", point " << i << " at " << distance[i];
      ASSERT_EQ(distance[i] < 0, expected) << "seed " << kSeed << ", point " << i;
    }
  }
}

TEST_P(Doubles, RaysThatBeginNearASurfaceCrossWhatLiesAhead) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> way(-1, 1);
  for (const Mesh& mesh : {cube(), torus(11, 7, random)}) {
    const Scene scene = scene_of(mesh.vertices, mesh.triangles);
    std::vector<Point> origins(1000), directions(1000);
    for (Point& p : origins) p = near_surface(mesh, random);
    for (Point& d : directions) d = {way(random), way(random), way(random)};
    const Rays rays{{&origins.front()[0], origins.size(), sizeof(Point)},
                    {&directions.front()[0], directions.size(), sizeof(Point)}};
    std::vector<std::uint32_t> counts(origins.size());
    scene.count(rays, counts);
    const AllHits all = scene.all(rays);
    for (std::size_t i = 0; i < origins.size(); ++i) {
      const auto expected = crossed(mesh, origins[i], directions[i]);
      if (!expected) continue;
      ASSERT_EQ(counts[i], expected->size()) << "seed " << kSeed << ", ray " << i;
      ASSERT_EQ(all.splits[i + 1] - all.splits[i], expected->size()) << "seed " << kSeed << ", ray " << i;
      for (std::size_t k = 0; k < expected->size(); ++k) {
        const double t = (*expected)[k].get_d();
        // What is nearly parallel to the plane is known less well.
        ASSERT_NEAR(all.t[all.splits[i] + k], t, 1e-11 + 1e-13 * t) << "seed " << kSeed << ", ray " << i;
      }
    }
  }
}

TEST_P(Doubles, ThoseOfTheCubesAreWhatTheyAre) {
  const Mesh mesh = cube();
  const Scene scene = scene_of(mesh.vertices, mesh.triangles);
  const std::vector<double> points = {1 + 3e-8, 0.3, 0.2, 1 - 3e-8, 0.3, 0.2};
  std::vector<std::uint8_t> inside(2);
  std::vector<double> distance(2);
  scene.inside(points, inside);
  scene.signed_distance(points, distance);
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{0, 1}));
  EXPECT_DOUBLE_EQ(distance[0], points[0] - 1);
  EXPECT_DOUBLE_EQ(distance[1], points[3] - 1);
  std::vector<std::uint32_t> count(1);
  const std::vector<double> from = {0.1, 0.2, 1 - 1e-8}, along = {1, 0.01, 0};
  scene.count({from, along}, count);
  EXPECT_EQ(count[0], 1u);
  const AllHits all = scene.all({std::vector<double>{0.1, 0.2, 0.3}, std::vector<double>{1, 0.1, 0.05}});
  ASSERT_EQ(all.t.size(), 1u);
  EXPECT_DOUBLE_EQ(all.t[0], 0.9);
}

// Through diagonals, edges and vertices, where no sign is sure in doubles: each crossing counts once.
TEST_P(Doubles, RaysThroughEdgesCrossThemOnce) {
  const Mesh mesh = cube();
  const Scene scene = scene_of(mesh.vertices, mesh.triangles);
  for (const double beside : {3e-8, -3e-8})
    for (const double y : {-1.0, -0.5, 0.0, 0.5, 1.0})
      for (const double z : {-1.0, -0.5, 0.0, 0.5, 1.0})
        for (const double lean : {0.0, 0.25}) {
          std::vector<std::uint32_t> count(1);
          scene.count({std::vector<double>{1 + beside, y, z}, std::vector<double>{-1, lean, lean}}, count);
          const bool through = std::max(std::abs(y), std::abs(z)) < 1;
          ASSERT_TRUE(!through || count[0] == (beside > 0 ? 2u : 1u)) << y << ' ' << z << ' ' << lean;
          ASSERT_TRUE(beside < 0 || count[0] % 2 == 0) << y << ' ' << z << ' ' << lean;
        }
}

// A cube of 1 m among corners 200 km apart, whose own are floats there still.
TEST_P(Doubles, AMillimetreCountsIn200Kilometres) {
  Mesh mesh = cube();
  for (float& x : mesh.vertices) x = 60000 + 0.5f * x;
  for (const float x : {-100000.0f, 100000.0f})
    for (const float y : {0.0f, 1.0f, 2.0f}) mesh.vertices.insert(mesh.vertices.end(), {x, y * y, x + y});
  mesh.triangles.insert(mesh.triangles.end(), {8, 9, 10, 11, 12, 13});
  const Scene scene = scene_of(mesh.vertices, mesh.triangles);
  const std::vector<double> points = {60000.501, 60000.1, 60000.2, 60000.499, 60000.1, 60000.2};
  std::vector<std::uint8_t> inside(2);
  std::vector<double> distance(2);
  scene.inside(points, inside);
  scene.signed_distance(points, distance);
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{0, 1}));
  EXPECT_NEAR(distance[0], 0.001, 1e-11);
  EXPECT_NEAR(distance[1], -0.001, 1e-11);
}

TEST_P(Doubles, DistancesAreThoseOfDoubles) {
  const std::vector<double> corners = {-300, -300, 500, 300, -300, 500, 300, 300, 500, -300, 300, 500};
  const Scene scene = scene_of(corners, {0, 1, 2, 0, 2, 3});
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> beside(-100, 100), slope(-0.2, 0.2);
  std::vector<Point> origins(1000), directions(1000);
  for (Point& p : origins) p = {beside(random), beside(random), beside(random)};
  for (Point& d : directions) d = {slope(random), slope(random), 1 + slope(random)};
  std::vector<double> t(origins.size());
  std::vector<Point> point(origins.size());
  const Rays rays{{&origins.front()[0], origins.size(), sizeof(Point)},
                  {&directions.front()[0], directions.size(), sizeof(Point)}};
  scene.closest(rays, {.t = t, .point = {&point.front()[0], point.size(), sizeof(Point)}});
  const AllHits all = scene.all(rays);
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double expected = (500 - origins[i][2]) / directions[i][2];
    ASSERT_NEAR(all.t[all.splits[i]], expected, 1e-15 * 1000) << "seed " << kSeed << ", ray " << i;
    ASSERT_NEAR(t[i], expected, 1e-15 * 1000) << "seed " << kSeed << ", ray " << i;
    ASSERT_NEAR(point[i][2], 500, 1e-12);
  }
}

// Asks for closest hits with the t of the last one as t_min, until all rays have missed: t of each.
std::vector<std::vector<double>> followed(const Scene& scene, const std::vector<Point>& origins,
                                          const std::vector<Point>& directions) {
  const std::size_t n = origins.size();
  std::vector<std::vector<double>> all(n);
  std::vector<double> t_min(n, 0), t(n);
  std::vector<Point> normal(n);
  for (bool any = true; any; t_min = t) {
    any = false;
    scene.closest(
        {{&origins.front()[0], n, sizeof(Point)}, {&directions.front()[0], n, sizeof(Point)}, t_min},
        {.t = t, .normal = {&normal.front()[0], n, sizeof(Point)}});
    for (std::size_t i = 0; i < n; ++i) {
      any |= t[i] < kInfinity;
      if (t[i] == kInfinity)
        t[i] = t_min[i];  // and misses again
      else if (all[i].push_back(t[i]); all[i].size() > 100)
        return all;
    }
  }
  return all;
}

// Each is met once, at the t that exact arithmetic gives it.
TEST_P(Doubles, ClosestHitsFollowEachOther) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> way(-1, 1);
  const Mesh mesh = torus(13, 9, random);
  const Scene scene = scene_of(mesh.vertices, mesh.triangles);
  std::vector<Point> origins(1000), directions(1000);
  for (Point& p : origins) p = {way(random), way(random), 0.3 * way(random)};
  for (Point& d : directions) d = {way(random), way(random), 0.1 * way(random)};
  const auto all = followed(scene, origins, directions);
  std::size_t n = 0;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const auto expected = crossed(mesh, origins[i], directions[i]);
    if (!expected) continue;
    ASSERT_EQ(all[i].size(), expected->size()) << "seed " << kSeed << ", ray " << i;
    for (std::size_t k = 0; k < expected->size(); ++k, ++n) {
      const double t = (*expected)[k].get_d();
      ASSERT_NEAR(all[i][k], t, 1e-11 + 1e-13 * t) << "seed " << kSeed << ", ray " << i;
    }
  }
  EXPECT_GT(n, origins.size());
}

// t_min and t_max beside hits, by less than floats tell apart, or on them: each question leaves out the same.
// (Rays within a rounding of an edge are not among these: floats and doubles may take either triangle's t.)
TEST_P(Doubles, HitsLieBetweenTheEndsOfTheirRays) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> way(-1, 1);
  const Mesh mesh = torus(13, 9, random);
  const Scene scene = scene_of(mesh.vertices, mesh.triangles);
  const std::size_t n = 3000;
  std::vector<Point> origins(n), directions(n);
  for (Point& p : origins) p = {2 * way(random), 2 * way(random), way(random)};
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < 3; ++k) directions[i][k] = 0.7 * way(random) - origins[i][k];
  Rays rays{{&origins.front()[0], n, sizeof(Point)}, {&directions.front()[0], n, sizeof(Point)}};
  std::vector<double> no_t_min(n, -kInfinity), t_min(n), t_max(n);
  rays.t_min = no_t_min;
  const AllHits whole = scene.all(rays);  // of lines
  const double beside[] = {1 - 1e-9, 1, 1 + 1e-9};
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t first = whole.splits[i], n_here = whole.splits[i + 1] - first;
    const auto end = [&](double otherwise) {
      if (n_here == 0 || random() % 3 == 0) return otherwise;
      return whole.t[first + random() % n_here] * beside[random() % 3];
    };
    t_min[i] = end(-1e3), t_max[i] = end(kInfinity);
  }
  rays.t_min = t_min, rays.t_max = t_max;
  std::vector<double> t(n);
  std::vector<std::uint32_t> counts(n);
  scene.closest(rays, {.t = t});
  scene.count(rays, counts);
  const AllHits all = scene.all(rays);
  std::size_t n_hits = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto of = [i](const AllHits& hits) {
      return std::vector<double>(hits.t.data() + hits.splits[i], hits.t.data() + hits.splits[i + 1]);
    };
    std::vector<double> expected = of(whole);
    std::erase_if(expected, [&](double e) { return !(e > t_min[i] && e < t_max[i]); });
    ASSERT_EQ(of(all), expected) << i;
    ASSERT_EQ(counts[i], expected.size()) << i;
    n_hits += expected.size();
    // What it may pass by is a surface so near to t_min that floats don't tell.
    if (!expected.empty() && expected.front() < t_min[i] + 1e-4) continue;
    ASSERT_EQ(t[i], expected.empty() ? kInfinity : expected.front()) << i;
  }
  EXPECT_GT(n_hits, 1000u);
}

// Whether floats put the start before or behind the surface: what lies behind it in double is none.
TEST_P(Doubles, NoClosestHitLiesBehindTheStart) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> way(-1, 1);
  for (const Mesh& mesh : {cube(), torus(11, 7, random)}) {
    const Scene scene = scene_of(mesh.vertices, mesh.triangles);
    std::vector<Point> origins(2000), directions(2000);
    for (Point& p : origins) p = near_surface(mesh, random);
    for (Point& d : directions) d = {way(random), way(random), way(random)};
    const std::size_t n = origins.size();
    std::vector<double> t(n);
    scene.closest({{&origins.front()[0], n, sizeof(Point)}, {&directions.front()[0], n, sizeof(Point)}},
                  {.t = t});
    for (std::size_t i = 0; i < n; ++i) {
      const auto expected = crossed(mesh, origins[i], directions[i]);
      if (!expected) continue;
      const bool is_one = std::ranges::any_of(
          *expected, [&](const mpq_class& e) { return std::abs(e.get_d() - t[i]) <= 1e-11 + 1e-13 * t[i]; });
      ASSERT_TRUE(t[i] == kInfinity || is_one) << "seed " << kSeed << ", ray " << i << " at " << t[i];
      // What it may pass by is a surface so near that floats don't tell.
      const auto first = std::ranges::find_if(*expected, [](const mpq_class& e) { return e.get_d() > 1e-4; });
      const double most = first == expected->end() ? kInfinity : first->get_d() * (1 + 1e-12);
      ASSERT_LE(t[i], most) << "seed " << kSeed << ", ray " << i;
    }
  }
}

TEST_P(Doubles, PointsNearShapesAreOnTheirSide) {
  Scene scene;
  scene.add_spheres({std::vector<double>{-2, 0, 0}, std::vector<double>{0.7}});
  scene.add_tori({std::vector<double>{2, 0, 0}, std::vector<double>{0, 0, 1}, std::vector<double>{0.75},
                  std::vector<double>{0.25}});
  scene.commit(options());
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> size(-9, -6), angle(-3, 3);
  std::vector<Point> points(4000);
  const double radius = 0.7f;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double off = std::pow(10.0, size(random)) * (random() % 2 ? 1 : -1);
    if (i % 2) {
      Point n{normal(random), normal(random), normal(random)};
      const double length = std::hypot(n[0], n[1], n[2]);
      points[i] = {-2 + (radius + off) * n[0] / length, (radius + off) * n[1] / length,
                   (radius + off) * n[2] / length};
    } else {
      const double a = angle(random), b = angle(random), r = 0.75 + (0.25 + off) * std::cos(b);
      points[i] = {2 + r * std::cos(a), r * std::sin(a), (0.25 + off) * std::sin(b)};
    }
  }
  const Points given(&points.front()[0], points.size(), sizeof(Point));
  std::vector<std::uint8_t> inside(points.size());
  scene.inside(given, inside);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point& p = points[i];
    const long double x = p[0] + 2.0L, ring = std::hypot(p[0] - 2.0L, static_cast<long double>(p[1])) - 0.75L;
    const bool expected = i % 2 ? std::hypot(x, p[1], p[2]) < radius : std::hypot(ring, p[2]) < 0.25L;
    ASSERT_EQ(inside[i] != 0, expected) << "seed " << kSeed << ", point " << i;
  }
}

TEST_P(Doubles, InstancesHaveTheSameSides) {
  const Mesh mesh = cube();
  Scene scene;
  const GeometryId made = scene.add_mesh({mesh.vertices, mesh.triangles}, {.prototype = true});
  const std::vector<double> twice = {2, 0, 0, 4, 0, 2, 0, 0, 0, 0, 2, 0};
  scene.add_instances(made, twice);
  scene.commit(options());
  const std::vector<double> points = {6 + 3e-8, 0.3, 0.2, 6 - 3e-8, 0.3, 0.2};
  std::vector<std::uint8_t> inside(2);
  scene.inside(points, inside);
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{0, 1}));
  const AllHits all = scene.all({std::vector<double>{4.2, 0.6, 0.3}, std::vector<double>{1, 0.1, 0.05}});
  ASSERT_FALSE(all.t.empty());
  EXPECT_NEAR(all.t[0], 1.8, 1e-14);
}

TEST_P(Doubles, PointsThatAreNotFiniteHaveNoSign) {
  const Mesh mesh = cube();
  const Scene scene = scene_of(mesh.vertices, mesh.triangles);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> points = {0, nan, 0, kInfinity, 0, 0, 0, -kInfinity, nan, 0, 0, 0};
  std::vector<double> distance(4);
  std::vector<std::uint8_t> inside(4);
  PointOptions options;
  options.invalid = InvalidRays::miss;
  EXPECT_EQ(scene.signed_distance(points, distance, options).invalid, 3u);
  EXPECT_TRUE(std::isnan(distance[0]));
  EXPECT_EQ(distance[1], kInfinity);
  EXPECT_TRUE(std::isnan(distance[2]));
  EXPECT_EQ(distance[3], -1);
  scene.inside(points, inside, options);
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{0, 0, 0, 1}));
}

// ---- Rays with very many hits.

// Sheets one behind the other, and rays through all of them.
struct Sheets {
  std::vector<float> vertices;
  std::vector<std::uint32_t> triangles;
  std::vector<Ray> rays;

  Sheets(std::uint32_t n_sheets, std::size_t n_rays) {
    for (std::uint32_t i = 0; i < n_sheets; ++i) {
      const float z = static_cast<float>(i);
      for (const float x : {-9.0f, 0.0f, 9.0f})
        vertices.insert(vertices.end(), {x, x == 0 ? 9.0f : -9.0f, z});
      triangles.insert(triangles.end(), {3 * i, 3 * i + 1, 3 * i + 2});
    }
    for (std::size_t i = 0; i < n_rays; ++i)
      rays.push_back({{0.001f * static_cast<float>(i % 1000), 0, -1},
                      0,
                      {0, 0, 1},
                      std::numeric_limits<float>::infinity()});
  }
};

TEST_P(Doubles, ACallOfManyHitsLooksForCancellationBetweenLaunches) {
  const Sheets sheets(500, 600);  // fewer rays than are taken at a time
  const Scene scene = scene_of(sheets.vertices, sheets.triangles);
  for (const bool counts_alone : {false, true}) {
    int looked = 0;
    const auto ask = [&](int last) {
      looked = 0;
      const Cancel cancel([&] { return ++looked > last; });
      std::vector<std::uint32_t> counts(sheets.rays.size());
      counts_alone ? static_cast<void>(scene.count(Rays::of(sheets.rays), counts, {.cancel = cancel}))
                   : static_cast<void>(scene.all(Rays::of(sheets.rays), {{.cancel = cancel}}));
    };
    ask(1'000'000);
    EXPECT_GE(looked, 3) << "there are several launches";
    EXPECT_TRUE(fails([&] { ask(2); }, "cancelled", ErrorCode::cancelled));
    EXPECT_EQ(looked, 3);
  }
}

TEST_P(Doubles, CallsOfPointsLookForCancellationToo) {
  const Mesh mesh = cube();
  const Scene scene = scene_of(mesh.vertices, mesh.triangles);
  const std::vector<float> points(3 * 100'000, 0.25f);
  std::vector<float> distance(100'000);
  int looked = 0;
  const Cancel cancel([&] { return ++looked > 1; });
  PointOptions options;
  options.cancel = cancel;
  EXPECT_TRUE(fails([&] { scene.closest_points(points, {.distance = distance}, options); }, "cancelled",
                    ErrorCode::cancelled));
  EXPECT_EQ(looked, 2);
}

TEST_P(Doubles, AnAnswerTooLargeForMemoryIsRefusedWithTheNumberOfHits) {
  const Sheets sheets(100, 5000);
  const Scene scene = scene_of(sheets.vertices, sheets.triangles);
  AllHitsOptions options;
  options.max_bytes = 300'000 * 28;  // of the 500,000 hits that there are
  EXPECT_TRUE(
      fails([&] { scene.all(Rays::of(sheets.rays), options); },
            "all hits: the first 5000 of 5000 rays have 500000 hits, which take 14000000 bytes, and 8400000 "
            "are allowed (max_bytes); ask for the first hits of each ray alone (max_hits), or for fewer rays",
            ErrorCode::out_of_memory));
  options.max_hits = 60;
  EXPECT_EQ(scene.all(Rays::of(sheets.rays), options).t.size(), 300'000u);
  options.max_hits = 0xffffffffu;
  options.max_bytes = 500'000 * 28;
  const AllHits all = scene.all(Rays::of(sheets.rays), options);
  ASSERT_EQ(all.t.size(), 500'000u);
  for (std::size_t i = 0; i < all.t.size(); ++i) ASSERT_EQ(all.t[i], 1.0 + static_cast<double>(i % 100));
}

}  // namespace
}  // namespace kdray
