// Calls of many rays or points to scenes of doubles, at which the device looks first: answers are those of
// few, which the host gives alone, however the arrays lie in memory.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <utility>
#include <vector>

#include "api/double_scenes.h"
#include "support/errors.h"

namespace kdray {
namespace {

using namespace test::doubles;
using test::fails;
using test::Point;

constexpr unsigned kSeed = 440;

class ManyOfDoubles : public OnEachDevice {};
KDRAY_FOR_EACH_DEVICE(ManyOfDoubles);

// One origin for all, rows with gaps, rows at odd addresses, and floats; more than whole groups of eight.
TEST_P(ManyOfDoubles, ManyRaysMayLieInMemoryInAnyWay) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 11);
  const DoubleMesh mesh = ring(9, 7, {0.5, 0.25, -0.5}, 1, random);
  const Scene scene = scene_of(mesh);
  const std::size_t n = kMany + 5;
  const RayList list = aimed(mesh, n, 1, random);
  const auto ask = [&](const Rays& rays) {
    std::vector<double> t(n);
    scene.closest(rays, {.t = t});
    return t;
  };
  struct Wide {
    Point origin;
    double between;
    Point direction;
    float after;
  };
  std::vector<Wide> wide(n);
  std::vector<double> t_min(n), t_max(n);
  for (std::size_t i = 0; i < n; ++i) {
    wide[i] = {list.origins[i], NAN, list.directions[i], 0};
    t_max[i] = i % 3 == 0 ? 0.5 : kInfinity;
  }
  const std::vector<double> right = ask(list.rays());
  EXPECT_GT(std::ranges::count_if(right, [](double t) { return std::isfinite(t); }), n / 4);
  const auto rows = [&](const Point& first) { return Points(&first[0], n, sizeof(Wide)); };
  EXPECT_EQ(ask({rows(wide[0].origin), rows(wide[0].direction)}), right);
  EXPECT_EQ(ask({list.rays().origins, rows(wide[0].direction)}), right);
  std::vector<char> odd(n * sizeof(Point) + 1);
  std::memcpy(odd.data() + 1, list.directions.data(), n * sizeof(Point));
  const Points odd_rows(reinterpret_cast<const double*>(odd.data() + 1), n, sizeof(Point));
  EXPECT_EQ(ask({list.rays().origins, odd_rows}), right);
  const std::vector<Point> one(n, list.origins[0]);
  EXPECT_EQ(ask({Points(&list.origins[0][0], 1, sizeof(Point)), list.rays().directions}),
            ask({Points(&one[0][0], n, sizeof(Point)), list.rays().directions}));
  std::vector<std::array<float, 3>> floats(n);
  std::vector<Point> of_floats(n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      of_floats[i][k] = floats[i][k] = static_cast<float>(list.directions[i][k]);
  EXPECT_EQ(ask({list.rays().origins, Points(&floats[0][0], n, sizeof floats[0])}),
            ask({list.rays().origins, Points(&of_floats[0][0], n, sizeof(Point))}));
  const std::vector<double> ended = ask(
      {.origins = list.rays().origins, .directions = list.rays().directions, .t_min = t_min, .t_max = t_max});
  for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(ended[i], right[i] < t_max[i] ? right[i] : kInfinity) << i;
}

// One ray that is none among many, from near by and from afar.
TEST_P(ManyOfDoubles, AFaultyRayIsToldAmongMany) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 7);
  const DoubleMesh mesh = ring(9, 7, {1e3, 0, 0}, 1, random);
  const Scene scene = scene_of(mesh);
  constexpr std::size_t kFaulty = 20011;
  for (const double away : {0.5, 1e4}) {
    RayList list;
    for (std::size_t i = 0; i < kMany; ++i) {
      list.origins.push_back({1e3, 0, away});
      list.directions.push_back({0.7, 0.001 * static_cast<double>(i % 100), -away});
      list.t_min.push_back(0);
      list.t_max.push_back(kInfinity);
    }
    const auto with = [&](double* value, double faulty) {
      SCOPED_TRACE(faulty);
      const double sound = std::exchange(*value, faulty);
      std::vector<double> t(kMany);
      std::vector<std::uint8_t> any(kMany);
      std::vector<std::uint32_t> counts(kMany);
      EXPECT_TRUE(fails([&] { scene.closest(list.rays(), {.t = t}); }, "ray 20011"));
      EXPECT_TRUE(fails([&] { scene.any(list.rays(), any); }, "ray 20011"));
      EXPECT_TRUE(fails([&] { scene.count(list.rays(), counts); }, "ray 20011"));
      EXPECT_TRUE(fails([&] { (void)scene.all(list.rays()); }, "ray 20011"));
      QueryOptions miss;
      miss.invalid = InvalidRays::miss;
      EXPECT_EQ(scene.closest(list.rays(), {.t = t}, miss).invalid, 1);
      EXPECT_EQ(t[kFaulty], kInfinity);
      EXPECT_LT(t[kFaulty + 1], kInfinity);
      EXPECT_EQ(scene.any(list.rays(), any, miss).invalid, 1);
      EXPECT_EQ(any[kFaulty], 0);
      EXPECT_EQ(scene.count(list.rays(), counts, miss).invalid, 1);
      EXPECT_EQ(counts[kFaulty], 0);
      *value = sound;
    };
    Point &origin = list.origins[kFaulty], &direction = list.directions[kFaulty];
    const double nan = std::nan("");
    for (const double faulty : {nan, kInfinity, -kInfinity}) {
      with(&origin[2], faulty);
      with(&direction[1], faulty);
      if (faulty != -kInfinity) with(&list.t_min[kFaulty], faulty);  // which is a whole line's
    }
    with(&list.t_max[kFaulty], nan);
    const Point sound = std::exchange(direction, Point{});
    with(&direction[0], 0);
    direction = sound;
  }
}

// Geometries with masks, and rays that see one of them or none.
TEST_P(ManyOfDoubles, MasksHoldForManyRays) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 5);
  const DoubleMesh inner = ring(9, 7, {1e3, 0, 0}, 1, random), outer = ring(9, 7, {1e3, 0, 0}, 1.5, random);
  Scene scene;
  scene.set_mask(scene.add_mesh({outer.points(), outer.triangles}), 1);
  scene.set_mask(scene.add_mesh({inner.points(), inner.triangles}), 2);
  scene.commit(options());
  const RayList list = aimed(inner, 500, 1, random);
  const std::size_t n = list.origins.size(), copies = 40;
  std::vector<std::uint32_t> few_masks, few_geometry(n), masks, geometry(n * copies);
  RayList many;
  for (std::size_t i = 0; i < n; ++i) few_masks.push_back(static_cast<std::uint32_t>(random() % 4));
  for (std::size_t i = 0; i < n * copies; ++i) {
    many.origins.push_back(list.origins[i % n]);
    many.directions.push_back(list.directions[i % n]);
    masks.push_back(few_masks[i % n]);
  }
  Rays few_rays = list.rays(), many_rays = many.rays();
  few_rays.masks = few_masks, many_rays.masks = masks;
  scene.closest(few_rays, {.geometry = few_geometry});
  scene.closest(many_rays, {.geometry = geometry});
  std::vector<std::uint32_t> few_counts(n), counts(n * copies);
  scene.count(few_rays, few_counts);
  scene.count(many_rays, counts);
  for (std::size_t i = 0; i < n * copies; ++i) {
    ASSERT_EQ(geometry[i], few_geometry[i % n]) << i;
    ASSERT_EQ(counts[i], few_counts[i % n]) << i;
  }
  EXPECT_GT(std::ranges::count(few_geometry, 0u), 20);
  EXPECT_GT(std::ranges::count(few_geometry, 1u), 20);
}

// Of many the device looks first, of few it doesn't: also within a radius, and from beyond the scene.
TEST_P(ManyOfDoubles, ManyPointsAreMeasuredAsFewAre) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 12);
  DoubleMesh mesh = ring(9, 7, {0.1, 0.2, 0.3}, 1e-9, random);
  add(mesh, ring(9, 7, {3, 4, 5}, 10, random));
  add(mesh, sheets());
  const Scene scene = scene_of(mesh);
  std::vector<Point> points;
  std::normal_distribution<double> around;
  while (points.size() < kMany) {
    const Point corner = mesh.corner(random() % mesh.size(), random() % 3);
    const double far = std::pow(10.0, static_cast<int>(random() % 16) - 11);
    points.push_back(corner);
    if (random() % 8 == 0) continue;  // it lies on the surface
    for (double& c : points.back()) c += far * around(random);
  }
  points[0] = {1e300, 0, 0};
  struct Answers {
    std::vector<double> distance, with_sign;
    std::vector<std::uint32_t> primitive;
  };
  const auto ask = [&](std::size_t first, std::size_t n, double radius) {
    Answers a{std::vector<double>(n), std::vector<double>(n), std::vector<std::uint32_t>(n)};
    const Points given(&points[first][0], n, sizeof(Point));
    PointOptions options;
    options.radius = radius;
    scene.closest_points(given, {.distance = a.distance, .primitive = a.primitive}, options);
    scene.signed_distance(given, a.with_sign, options);
    return a;
  };
  for (const double radius : {kInfinity, 1e-3, 0.0}) {
    SCOPED_TRACE(radius);
    const Answers many = ask(0, points.size(), radius);
    std::size_t n_near = 0;
    for (std::size_t first = 0; first < points.size(); first += 512) {
      const Answers few = ask(first, 512, radius);
      for (std::size_t i = 0; i < 512; ++i) {
        ASSERT_EQ(many.distance[first + i], few.distance[i]) << first + i;
        ASSERT_EQ(many.primitive[first + i], few.primitive[i]) << first + i;
        ASSERT_EQ(many.with_sign[first + i], few.with_sign[i]) << first + i;
        n_near += few.distance[i] <= radius;
      }
    }
    EXPECT_GT(n_near, points.size() / 16);
  }
}

}  // namespace
}  // namespace kdray
