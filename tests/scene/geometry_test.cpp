#include "scene/model/geometry.h"

#include <random>

#include "scene/scratch.h"

namespace kdray::scene {
namespace {

using test::refusal;

Scene triangle_scene(const std::vector<dvec3>& corners) {
  Scene s;
  s.materials.emplace_back();
  s.vertices.assign(corners.begin(), corners.end());
  for (std::uint32_t i = 0; i + 2 < corners.size(); i += 3) {
    s.triangles.push_back({.vertex = {i, i + 1, i + 2}, .number = i / 3});
  }
  return s;
}

Scene scene_of(const Sphere& sphere) {
  Scene s;
  s.spheres = {sphere};
  return s;
}

Scene scene_of(const Cone& cone) {
  Scene s;
  s.cones = {cone};
  return s;
}

dvec3 world(const Geometry& g, const vec3& local) {
  return g.space.world(dvec3(local));
}

TEST(MakeGeometry, KeepsFloatsNearTheOriginAsTheyAre) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> coordinate(-1, 3);  // the middle is not at the origin
  std::vector<dvec3> corners(300);
  for (dvec3& p : corners) p = dvec3(coordinate(random), coordinate(random), coordinate(random));
  const Geometry g = make_geometry(triangle_scene(corners));
  EXPECT_EQ(g.space.center, dvec3(0));
  ASSERT_EQ(g.triangles.size(), 100u);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    EXPECT_EQ(world(g, vertex(g.triangles[i / 3], static_cast<int>(i % 3))), corners[i]);
  }
}

// Float coordinates far from the origin lose no bit by the move, whatever the place and size.
TEST(MakeGeometry, MovesFarFloatsWithoutLoss) {
  for (unsigned seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1), exponent(-3, 7);
    const double size = std::pow(10, exponent(random) / 2);
    const dvec3 place = dvec3(unit(random), unit(random), unit(random)) * std::pow(10, exponent(random));
    std::vector<dvec3> corners(60);
    for (dvec3& p : corners) {
      p = dvec3(vec3(place +
                     size * dvec3(unit(random), unit(random), unit(random))));  // as a file of floats has it
    }
    const Geometry g = make_geometry(triangle_scene(corners));
    for (const TriangleGeometry& t : g.triangles) {
      for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(world(g, vertex(t, i)), corners[t.number * 3 + i]) << "size " << size;
      }
    }
  }
}

TEST(MakeGeometry, KeepsTheShapeOfAModelAMillionAway) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<dvec3> corners(300);
  for (dvec3& p : corners) p = dvec3(1e6) + dvec3(unit(random), unit(random), unit(random));
  const Geometry g = make_geometry(triangle_scene(corners));
  EXPECT_NEAR(g.space.center.x, 1e6, 1);
  for (const TriangleGeometry& t : g.triangles) {
    for (int i = 0; i < 3; ++i) {
      const dvec3 back = world(g, vertex(t, i));
      EXPECT_LT(glm::length(back - corners[t.number * 3 + i]), 1e-7) << "float at 1e6 would be off by 0.03";
    }
  }
}

TEST(MakeGeometry, DropsTrianglesOfEqualCornersAndKeepsThoseOnALine) {
  const Scene s = triangle_scene({
      {0, 0, 0},
      {1, 0, 0},
      {0, 1, 0},  // fine
      {1, 1, 1},
      {1, 1, 1},
      {2, 2, 2},  // two corners the same
      {0, 0, 0},
      {1, 2, 3},
      {2, 4, 6},  // on a line
      {0, 0, 0},
      {0, 0, 1},
      {0, 1, 0},  // fine
      {0.1, 0.1, 0.1},
      {0.2, 0.2, 0.2},
      {0.3, 0.3, 0.3},  // on a line in float as well: x = y = z
  });
  const Geometry g = make_geometry(s);
  ASSERT_EQ(g.triangles.size(), 4u);
  EXPECT_EQ(std::vector<std::uint32_t>(g.sources.begin(), g.sources.end()),
            (std::vector<std::uint32_t>{0, 2, 3, 4}));
  EXPECT_EQ(g.dropped_degenerate, 1u);
  ASSERT_EQ(g.zero_area.size(), 2u);
  EXPECT_EQ(g.zero_area[0].triangle, 1u);
  EXPECT_EQ(g.zero_area[1].triangle, 3u);
  for (const std::size_t i : {0u, 2u}) EXPECT_EQ(g.triangles[i].normals, KDRAY_NO_NORMALS);
  EXPECT_EQ(g.triangles[1].normals, KDRAY_ZERO_AREA | 0u) << "which has vertex normals of its own";
  EXPECT_EQ(g.triangles[3].normals, KDRAY_ZERO_AREA | 1u);
  EXPECT_EQ(g.n_smooth, 2u);
}

TEST(MakeGeometry, DropsCornersThatAreEqualAfterRounding) {
  const Geometry g = make_geometry(triangle_scene({{0, 0, 0},
                                                   {1e9, 0, 0},
                                                   {1e9, 1e9, 0},
                                                   {1e9, 5e8, 0},
                                                   {1e9, 5e8 + 1, 0},
                                                   {1e9, 0, 0},
                                                   {1e9, 5e8, 0},
                                                   {1e9, 5e8 + 100, 0},
                                                   {1e9, 0, 0}}));
  EXPECT_EQ(g.dropped_degenerate, 1u);
  EXPECT_EQ(g.zero_area.size(), 1u);
  EXPECT_EQ(g.lost, 0u) << "they had no area to lose";
}

TEST(MakeGeometry, KeepsTheOrderAroundDroppedTrianglesOfALargeScene) {
  // More than are made at a time; flat ones singly, in rows, and none for long stretches.
  constexpr std::uint32_t kMany = 70000;
  std::mt19937 random(9);
  Scene s;
  s.materials.resize(2);
  s.normals = {vec3(0, 0, 1)};
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < kMany; ++i) {
    const bool flat = i < 20000 ? random() % 3 == 0 : i > 40000 && i < 62000;
    const auto first = static_cast<std::uint32_t>(s.vertices.size());
    const double x = i;
    for (const dvec3& p : {dvec3(x, 0, 0), dvec3(x + 1, 0, 0), dvec3(x, flat ? 0 : 1, 0)})
      s.vertices.push_back(p);
    s.triangles.push_back({.vertex = {first, first + 1, first + 2}, .material = i % 2, .number = i});
    if (i % 5 == 0) s.triangles.back().normal = {0, 0, 0};
    if (!flat) kept.push_back(i);
  }
  const Geometry g = make_geometry(s);
  EXPECT_EQ(g.dropped_degenerate, kMany - kept.size());
  ASSERT_EQ(g.triangles.size(), kept.size());
  Box bounds;
  std::uint32_t n_smooth = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    ASSERT_EQ(g.sources[i], kept[i]);
    ASSERT_EQ(g.triangles[i].number, kept[i]);
    ASSERT_EQ(g.triangles[i].material, kept[i] % 2);
    ASSERT_EQ(g.triangles[i].normals, kept[i] % 5 == 0 ? n_smooth++ : KDRAY_NO_NORMALS);
    ASSERT_EQ(world(g, vertex(g.triangles[i], 1)), dvec3(kept[i] + 1.0, 0, 0));
    bounds.grow(bounds_of(g.triangles[i]));
  }
  EXPECT_EQ(g.bounds.lo, bounds.lo);
  EXPECT_EQ(g.bounds.hi, bounds.hi);
  EXPECT_EQ(g.n_smooth, n_smooth);
}

// One ulp off a line is area enough.
TEST(MakeGeometry, DecidesFlatnessExactly) {
  const double x = 1 + 0x1p-23;
  for (const double third : {std::nextafter(3.0f, 0.0f) * 1.0, 3.0, std::nextafter(3.0f, 4.0f) * 1.0}) {
    const Geometry g = make_geometry(triangle_scene({{-1, -1, 5}, {1, 1, 5}, {3, third, 5}}));
    EXPECT_EQ(g.zero_area.size(), third == 3.0 ? 1u : 0u) << third;
    EXPECT_EQ(g.triangles.size(), 1u);
  }
  const Geometry g = make_geometry(triangle_scene({{0, 0, 0}, {x, 1, 0}, {x * x, x, 0}}));
  // x * x needs more bits than float has: in float the third corner is off the line.
  EXPECT_EQ(g.zero_area.size(), 0u);
}

TEST(MakeGeometry, DropsSpheresAndConesThatVanishInFloat) {
  Scene s;
  s.spheres = {{.center = dvec3(0), .radius = 1e-60}, {.center = dvec3(1), .radius = 1}};
  s.cones = {{.base = dvec3(0), .apex = dvec3(1), .base_radius = 1e-50, .apex_radius = 0},
             {.base = dvec3(0), .apex = dvec3(1e-50), .base_radius = 1, .apex_radius = 1},
             {.base = dvec3(0), .apex = dvec3(0, 0, 1), .base_radius = 1, .apex_radius = 0}};
  const Geometry g = make_geometry(s);
  ASSERT_EQ(g.spheres.size(), 1u);
  EXPECT_EQ(g.spheres[0].source, 1u);
  ASSERT_EQ(g.cones.size(), 1u);
  EXPECT_EQ(g.cones[0].source, 2u);
  EXPECT_EQ(g.dropped_degenerate, 3u);
  EXPECT_EQ(g.size(), 2u);
}

TEST(MakeGeometry, RefusesWhatDoubleCannotHold) {
  const auto refused = [](const Scene& s) {
    return refusal([&] { make_geometry(s); }).find("double precision") != std::string::npos;
  };
  EXPECT_TRUE(refused(triangle_scene({{-1e308, 0, 0}, {1e308, 0, 0}, {0, 1e308, 0}})));
  EXPECT_TRUE(refused(scene_of(Sphere{.center = dvec3(0), .radius = 1e308})));
  EXPECT_TRUE(
      refused(scene_of(Cone{.base = dvec3(0), .apex = dvec3(1), .base_radius = 1.5e308, .apex_radius = 1})));
  // Far away but small is no trouble.
  EXPECT_EQ(make_geometry(scene_of(Sphere{.center = dvec3(1e60), .radius = 1e50 * 0 + 1})).spheres.size(),
            1u);
}

// One mesh, sphere and cone at a thousand sizes: the same floats, bit for bit.
TEST(MakeGeometry, HasTheSameFloatsAtAnySize) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<dvec3> corners(30);
  for (dvec3& p : corners) p = dvec3(5) + dvec3(unit(random), unit(random), unit(random));
  const auto made = [&](double scale) {
    std::vector<dvec3> scaled(corners);
    for (dvec3& p : scaled) p *= scale;
    Scene s = triangle_scene(scaled);
    s.spheres = {{.center = dvec3(5.1 * scale), .radius = 0.3 * scale}};
    s.cones = {
        {.base = dvec3(4 * scale), .apex = dvec3(5 * scale), .base_radius = 0.1 * scale, .apex_radius = 0}};
    return make_geometry(s);
  };
  const Geometry one = made(1);
  EXPECT_GE(largest_component(glm::max(glm::abs(dvec3(one.bounds.lo)), glm::abs(dvec3(one.bounds.hi)))),
            kLocalReach);
  EXPECT_LT(largest_component(glm::max(glm::abs(dvec3(one.bounds.lo)), glm::abs(dvec3(one.bounds.hi)))),
            2 * kLocalReach);
  for (const int exponent : {-1000, -500, -133, -127, -40, -1, 1, 40, 100, 127, 500, 1000}) {
    SCOPED_TRACE(exponent);
    const double scale = std::ldexp(1.0, exponent);
    const Geometry g = made(scale);
    EXPECT_EQ(g.space.center, one.space.center * scale);
    EXPECT_EQ(g.space.scale * scale, one.space.scale);
    ASSERT_EQ(g.size(), one.size());
    for (std::size_t i = 0; i < g.triangles.size(); ++i)
      for (int k = 0; k < 3; ++k) EXPECT_EQ(vertex(g.triangles[i], k), vertex(one.triangles[i], k));
    EXPECT_EQ(g.spheres[0].center, one.spheres[0].center);
    EXPECT_EQ(g.spheres[0].radius, one.spheres[0].radius);
    EXPECT_EQ(g.cones[0].apex, one.cones[0].apex);
    EXPECT_EQ(g.cones[0].base_radius, one.cones[0].base_radius);
  }
}

TEST(RangeWarning, CountsWhatFloatsLose) {
  const std::vector<dvec3> floor = {{-1e10, 0, -1e10}, {1e10, 0, -1e10}, {0, 1e9, 1e10}};
  EXPECT_EQ(range_warning(make_geometry(triangle_scene(floor))), "");
  // Beside it, one triangle of size 1 near the origin, and one that vanishes far from it.
  std::vector<dvec3> corners(floor);
  corners.insert(corners.end(), {{0, 1, 0}, {1, 1, 0}, {0, 1, 1}});
  corners.insert(corners.end(), {{9.1e9, 1, 0}, {9.1e9 + 1, 1, 0}, {9.1e9, 1.5, 1}});
  const Geometry g = make_geometry(triangle_scene(corners));
  EXPECT_EQ(g.fine, 1u);
  EXPECT_EQ(g.lost, 1u);
  EXPECT_EQ(g.dropped_degenerate, 1u);
  EXPECT_NE(range_warning(g).find("ranges wider than single precision"), std::string::npos);
  // What has no area in the file is not lost.
  const Geometry flat = make_geometry(triangle_scene({{0, 0, 0},
                                                      {1, 0, 0},
                                                      {0, 1, 0},
                                                      {0.1, 0.1, 0},
                                                      {0.2, 0.2, 0},
                                                      {0.7, 0.7, 0},
                                                      {1, 1, 1},
                                                      {1, 1, 1},
                                                      {0, 0, 1}}));
  EXPECT_EQ(flat.dropped_degenerate, 1u);
  EXPECT_EQ(flat.zero_area.size(), 1u);
  EXPECT_EQ(flat.lost, 0u);
  EXPECT_EQ(range_warning(flat), "");
}

TEST(MakeGeometry, TakesAnEmptyScene) {
  const Geometry g = make_geometry(Scene{});
  EXPECT_EQ(g.size(), 0u);
  EXPECT_TRUE(g.bounds.empty());
  EXPECT_EQ(g.space, LocalSpace{});
}

TEST(SceneBounds, LeaveOutVerticesThatNoTriangleUses) {
  Scene s = triangle_scene({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  s.vertices.push_back(dvec3(100));
  EXPECT_EQ(s.bounds().hi, dvec3(1, 1, 0));
}

bool inside(const Box& box, const glm::dvec3& p) {
  return glm::all(glm::lessThanEqual(dvec3(box.lo), p)) && glm::all(glm::lessThanEqual(p, dvec3(box.hi)));
}

TEST(BoundsOf, ASphereAreTightAndHoldIt) {
  const Box box = bounds_of(SphereGeometry{vec3(1, 2, 3), 0.5f, 0});
  EXPECT_EQ(box.lo, vec3(0.5f, 1.5f, 2.5f));
  EXPECT_EQ(box.hi, vec3(1.5f, 2.5f, 3.5f));
  for (unsigned seed = 0; seed < 2000; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1), exponent(-30, 30);
    const SphereGeometry s{vec3(unit(random), unit(random), unit(random)) * std::exp2(exponent(random)),
                           std::exp2(exponent(random)), 0};
    const Box b = bounds_of(s);
    for (int i = 0; i < 3; ++i) {
      // long double holds the sum of two floats of this range with bits to spare for a fair comparison.
      const long double lo = static_cast<long double>(s.center[i]) - s.radius;
      const long double hi = static_cast<long double>(s.center[i]) + s.radius;
      EXPECT_LE(b.lo[i], lo) << "seed " << seed;
      EXPECT_GE(b.hi[i], hi) << "seed " << seed;
      EXPECT_GT(std::nextafter(b.lo[i], std::numeric_limits<float>::infinity()), lo) << "seed " << seed;
      EXPECT_LT(std::nextafter(b.hi[i], -std::numeric_limits<float>::infinity()), hi) << "seed " << seed;
    }
  }
}

TEST(BoundsOf, AConeAlongAnAxisAreExact) {
  const Box box = bounds_of(ConeGeometry{vec3(0, 0, -1), vec3(0, 0, 3), 2, 0.5f, 0});
  EXPECT_EQ(box.lo.z, -1);
  EXPECT_EQ(box.hi.z, 3);
  EXPECT_NEAR(box.hi.x, 2, 1e-6);
  EXPECT_GE(box.hi.x, 2);
  EXPECT_NEAR(box.lo.y, -2, 1e-6);
  const Box point = bounds_of(ConeGeometry{vec3(1, 1, 1), vec3(5, 1, 1), 1, 0, 0});
  EXPECT_EQ(point.lo.x, 1);
  EXPECT_EQ(point.hi.x, 5);
}

TEST(BoundsOf, ACone_HoldsItsSurfaceAndTouchesIt) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1), radius(0, 2);
    const vec3 place = vec3(unit(random), unit(random), unit(random)) * 100.0f;
    const ConeGeometry c{place, place + vec3(unit(random), unit(random), unit(random)), radius(random),
                         seed % 3 ? radius(random) : 0.0f, 0};
    const Box box = bounds_of(c);
    const dvec3 axis = dvec3(c.apex) - dvec3(c.base);
    const dvec3 w = glm::normalize(axis);
    const dvec3 u = glm::normalize(glm::cross(w, std::abs(w.x) < 0.5 ? dvec3(1, 0, 0) : dvec3(0, 1, 0)));
    const dvec3 v = glm::cross(w, u);
    DBox reached;
    for (int i = 0; i < 720; ++i) {
      const double phi = i * std::acos(-1.0) / 360;
      for (const double t : {0.0, 0.25, 0.5, 1.0}) {
        const double r = c.base_radius + t * (static_cast<double>(c.apex_radius) - c.base_radius);
        const dvec3 p = dvec3(c.base) + t * axis + r * (std::cos(phi) * u + std::sin(phi) * v);
        reached.grow(p);
        // The sample itself is rounded, by far less than a float's step at 100.
        EXPECT_TRUE(inside(Box{box.lo - 1e-12f, box.hi + 1e-12f}, p + (dvec3(c.base) - p) * 1e-13));
      }
    }
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(box.lo[i], reached.lo[i], 1e-4);
      EXPECT_NEAR(box.hi[i], reached.hi[i], 1e-4);
    }
  }
}

}  // namespace
}  // namespace kdray::scene
