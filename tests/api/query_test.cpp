// Queries on a program's arrays: float and double, any stride; what they promise of doubles far from the
// origin, of rays that mean nothing, of threads and of cancelling.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <thread>

#include "kdray/kdray.h"
#include "support/device.h"
#include "support/errors.h"
#include "support/meshes.h"

namespace kdray {
namespace {

using test::Cube;
using test::fails;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Query : public test::EachDevice {
 protected:
  CommitOptions options() const {
    CommitOptions options;
    options.device.device = GetParam();
    return options;
  }
  // A cube of that half side about a centre, in double.
  Scene cube_at(const std::array<double, 3>& center, double half) const {
    const Cube cube;
    std::vector<double> vertices;
    for (std::size_t i = 0; i < cube.vertices.size(); ++i)
      vertices.push_back(center[i % 3] + half * static_cast<double>(cube.vertices[i]));
    Scene scene;
    scene.add_mesh({vertices, cube.triangles});
    scene.commit(options());
    return scene;
  }
};
KDRAY_FOR_EACH_DEVICE(Query);

std::vector<Ray> random_rays(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> anywhere(-1.75f, 1.75f);
  std::vector<Ray> rays(n);
  for (Ray& ray : rays) {
    for (float& x : ray.origin) x = anywhere(random);
    for (float& x : ray.direction) x = anywhere(random);
    ray.t_min = 0;
    ray.t_max = std::numeric_limits<float>::infinity();
  }
  return rays;
}

TEST_P(Query, HitsAreThoseOfTheRendererBitForBit) {
  constexpr unsigned kSeed = 1;
  const std::vector<Ray> rays = random_rays(300'000, kSeed);  // more than a chunk
  Scene scene = Scene::load(std::string(KDRAY_SOURCE_DIR) + "/scenes/balls.nff");
  scene.commit(options());
  DeviceOptions device;
  device.device = GetParam();
  const std::vector<Hit> expected = Renderer(scene, {}, device).trace(rays);
  std::vector<float> t(rays.size()), u(rays.size()), v(rays.size());
  std::vector<std::uint32_t> primitive(rays.size());
  scene.closest(Rays::of(rays), {.t = t, .primitive = primitive, .u = u, .v = v});
  std::vector<std::uint8_t> any(rays.size());
  scene.any(Rays::of(rays), any);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(t[i], expected[i].t) << "seed " << kSeed << ", ray " << i;
    ASSERT_EQ(primitive[i], static_cast<std::uint32_t>(expected[i].primitive)) << i;
    ASSERT_EQ(u[i], expected[i].u) << i;
    ASSERT_EQ(v[i], expected[i].v) << i;
    ASSERT_EQ(any[i], expected[i].primitive >= 0 ? 1 : 0) << i;
  }
}

TEST_P(Query, EveryFormOfTheArraysGivesTheSame) {
  constexpr unsigned kSeed = 2;
  const std::vector<Ray> rays = random_rays(5000, kSeed);
  const Scene scene = cube_at({0, 0, 0}, 1);
  std::vector<double> t(rays.size());
  scene.closest(Rays::of(rays), {.t = t});

  std::vector<float> origins, directions;
  std::vector<double> d_origins, d_directions;
  for (const Ray& ray : rays) {
    origins.insert(origins.end(), ray.origin, ray.origin + 3);
    directions.insert(directions.end(), ray.direction, ray.direction + 3);
  }
  d_origins.assign(origins.begin(), origins.end());
  d_directions.assign(directions.begin(), directions.end());
  std::vector<double> apart(rays.size());
  scene.closest({origins, directions}, {.t = apart});
  EXPECT_EQ(apart, t) << "seed " << kSeed;
  std::vector<double> in_double(rays.size());
  scene.closest({d_origins, d_directions}, {.t = in_double});
  for (std::size_t i = 0; i < t.size(); ++i) {
    ASSERT_EQ(std::isinf(in_double[i]), std::isinf(t[i])) << "seed " << kSeed << ", ray " << i;
    const double expected = std::isinf(t[i]) ? in_double[i] : t[i];
    ASSERT_TRUE(in_double[i] == expected || std::abs(in_double[i] - expected) <= 1e-5 * expected + 1e-6)
        << "seed " << kSeed << ", ray " << i;
  }
  // Answers in a struct of the caller's, at an odd place.
#pragma pack(push, 1)
  struct Mine {
    char tag;
    float t;
    std::uint32_t primitive;
  };
#pragma pack(pop)
  std::vector<Mine> mine(rays.size());
  char* const first = reinterpret_cast<char*>(mine.data());
  scene.closest({origins, directions},
                {.t = {reinterpret_cast<float*>(first + 1), mine.size(), sizeof(Mine)},
                 .primitive = {reinterpret_cast<std::uint32_t*>(first + 5), mine.size(), sizeof(Mine)}});
  for (std::size_t i = 0; i < mine.size(); ++i) {
    const float found = mine[i].t;  // no reference to what lies at an odd place
    ASSERT_EQ(found, static_cast<float>(t[i])) << i;
  }
}

TEST_P(Query, SizesThatDontMatchAreToldByName) {
  const Scene scene = cube_at({0, 0, 0}, 1);
  const std::vector<float> two = {0, 0, 5, 0, 0, 6}, three = {0, 0, -1, 0, 0, -1, 0, 0, -1};
  std::vector<double> t(2);
  EXPECT_TRUE(fails([&] { scene.closest({two, three}, {.t = t}); }, "2 of origins for 3 rays"));
  std::vector<double> few(1);
  EXPECT_TRUE(fails([&] { scene.closest({two, two}, {.t = few}); }, "t: there are 1 places for 2 answers"));
  EXPECT_TRUE(fails([&] { scene.closest({two, {}}, {.t = t}); }, "origins without directions"));
}

TEST_P(Query, RaysThatMeanNothingAreRefusedOrCounted) {
  const Scene scene = cube_at({0, 0, 0}, 1);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                  kInf = std::numeric_limits<float>::infinity();
  std::vector<Ray> rays(6, Ray{{0, 0, 5}, 0, {0, 0, -1}, kInf});
  rays[1].origin[0] = kNan;
  rays[2].direction[2] = 0;
  rays[3].direction[0] = kInf;
  rays[4].t_max = kNan;
  std::vector<double> t(rays.size());
  EXPECT_TRUE(fails([&] { scene.closest(Rays::of(rays), {.t = t}); }, "ray 1: its origin is not finite"));
  const QueryReport report = scene.closest(Rays::of(rays), {.t = t}, {.invalid = InvalidRays::miss});
  EXPECT_EQ(report.invalid, 4u);
  EXPECT_EQ(t, (std::vector<double>{4, kInfinity, kInfinity, kInfinity, kInfinity, 4}));
}

// "A box of 1 mm 10 km away has its entry and its exit": rays from there, whose ends are known.
TEST_P(Query, DoublesSeeASmallBoxFarAway) {
  constexpr double kHalf = 0.0005;
  for (const std::array<double, 3>& center :
       {std::array<double, 3>{0, 0, 0}, {500'000.125, 4'649'776.25, 312.5}, {-1e7, 3e6, 5e5}}) {
    const Scene scene = cube_at(center, kHalf);
    for (const double away : {0.01, 1.0, 1e4, 1e6}) {
      const std::vector<double> origin = {center[0] + away, center[1] + 0.0001, center[2] - 0.0002};
      const std::vector<double> towards = {-1, 0, 0}, back = {-3, 0, 0};
      std::vector<double> entry(1), exit(1);
      scene.closest({origin, towards}, {.t = entry});
      // As exact as the file's own numbers: an ulp of the coordinates.
      const double ulp = 4e-16 * (std::abs(center[0]) + away) + 1e-7 * kHalf;
      EXPECT_NEAR(entry[0], away - kHalf, ulp) << away;
      // An ulp of t is a tenth of a micrometre of the box at most, up to 10 km away.
      if (away <= 1e4) {
        scene.closest({origin, towards, entry}, {.t = exit});
        EXPECT_NEAR(exit[0], away + kHalf, ulp) << away;
      }
      scene.closest({origin, back}, {.t = entry});
      EXPECT_NEAR(entry[0], (away - kHalf) / 3, ulp) << away;
    }
  }
}

// Embree's promise of a sphere of radius 2 at (148376, 1234, -223423), without its tolerance: every ray that
// aims at a point inside of it hits it.
TEST_P(Query, NoRayMissesASphereFarFromTheOrigin) {
  constexpr unsigned kSeed = 3;
  const std::array<double, 3> center{148376, 1234, -223423};
  Scene scene;
  scene.add_spheres({std::vector<double>{center[0], center[1], center[2]}, std::vector<double>{2}});
  scene.commit(options());
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  constexpr std::size_t kRays = 200'000;
  std::vector<double> origins, directions;
  for (std::size_t i = 0; i < kRays; ++i) {
    std::array<double, 3> at{}, from{};
    double length = 0, distance = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      at[k] = normal(random), from[k] = normal(random);
      length += at[k] * at[k], distance += from[k] * from[k];
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const double target = center[k] + 1.999999 * at[k] / std::sqrt(length);
      const double origin = center[k] + 1000 * from[k] / std::sqrt(distance);
      origins.push_back(origin);
      directions.push_back(target - origin);
    }
  }
  std::vector<std::uint8_t> hit(kRays);
  scene.any({origins, directions}, hit);
  EXPECT_EQ(std::count(hit.begin(), hit.end(), 0), 0) << "seed " << kSeed;
}

TEST_P(Query, ThreadsAskWhileTheSceneIsCommittedAnew) {
  const Cube cube;
  Scene scene;
  const GeometryId box = scene.add_mesh({cube.at(0, 0, 0), cube.triangles});
  scene.commit(options());
  std::atomic<bool> done{false};
  std::atomic<int> wrong{0}, asked{0};
  const auto ask = [&] {
    const std::vector<float> from = {0.25f, 0.25f, 50}, down = {0, 0, -1};
    std::vector<double> t(1);
    while (!done) {
      scene.closest({from, down}, {.t = t});
      // The cube is at one of the ten heights.
      const double height = 49 - t[0];
      if (height != std::round(height) || height < 0 || height > 9) ++wrong;
      ++asked;
    }
  };
  std::thread first(ask), second(ask);
  for (int i = 0; i < 20 || asked == 0; ++i) {
    scene.update_vertices(box, cube.at(0, 0, static_cast<float>(i % 10)));
    scene.commit(options());
  }
  done = true;
  first.join();
  second.join();
  EXPECT_EQ(wrong, 0);
}

TEST_P(Query, CanBeCancelledFromAnotherThread) {
  const Scene scene = cube_at({0, 0, 0}, 1);
  const std::vector<Ray> rays = random_rays(1 << 20, 4);
  Cancel cancel;
  cancel.cancel();
  std::vector<double> t(rays.size());
  EXPECT_TRUE(fails([&] { scene.closest(Rays::of(rays), {.t = t}, {.cancel = cancel}); }, "cancelled",
                    ErrorCode::cancelled));
  Cancel later;
  std::thread other([&] { later.cancel(); });
  try {
    for (int i = 0; i < 10'000; ++i) scene.closest(Rays::of(rays), {.t = t}, {.cancel = later});
    ADD_FAILURE() << "was not cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
  other.join();
}

TEST_P(Query, PicturesAreTakenOfWhatWasCommittedByAnyCamera) {
  const Scene scene = cube_at({0, 0, 0}, 1);
  RenderOptions picture;
  picture.width = picture.height = 32;
  const Picture framed = scene.render(picture);
  picture.camera = Camera{.from = {0, 0, 9}, .at = {0, 0, 20}};
  const Picture away = scene.render(picture);
  EXPECT_NE(framed.rgb, away.rgb);
  EXPECT_EQ(away.rgb, std::vector<float>(3 * 32 * 32, 0.0f)) << "it looks away";
  picture.camera = Camera{.from = {0, 0, 9}, .at = {0, 0, 9}};
  EXPECT_TRUE(fails([&] { scene.render(picture); }, "camera"));
}

TEST_P(Query, APictureCanBeCancelled) {
  Scene scene = Scene::load(std::string(KDRAY_SOURCE_DIR) + "/scenes/balls.nff");
  scene.commit(options());
  for (const Mode mode : {Mode::pdprt, Mode::odprt}) {
    RenderOptions picture;
    picture.width = picture.height = 2048;
    picture.samples = 64;
    picture.mode = mode;
    picture.cancel = Cancel();
    std::thread other([cancel = *picture.cancel]() mutable { cancel.cancel(); });
    EXPECT_TRUE(fails([&] { scene.render(picture); }, "cancelled", ErrorCode::cancelled));
    other.join();
  }
  RenderOptions small;
  small.width = small.height = 16;
  EXPECT_EQ(scene.render(small).width, 16) << "the next one is rendered as ever";
}

TEST_P(Query, CrossingsOfACubeAreTwoOrNoneWhereverRaysGo) {
  constexpr unsigned kSeed = 5;
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<int> grid(-2, 2);
  for (const std::array<double, 3>& center :
       {std::array<double, 3>{0, 0, 0}, {500'000.125, 4'649'776.25, 312.5}}) {
    const Scene scene = cube_at(center, 1);
    // Through corners, edges and faces: from grid points outside of the cube to others.
    std::vector<double> origins, directions;
    for (int i = 0; i < 20'000; ++i) {
      std::array<double, 3> from{}, to{};
      for (std::size_t k = 0; k < 3; ++k) from[k] = 3 * grid(random), to[k] = grid(random);
      if (std::max({std::abs(from[0]), std::abs(from[1]), std::abs(from[2])}) < 2 || from == to) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        origins.push_back(center[k] + from[k]);
        directions.push_back(to[k] - from[k]);
      }
    }
    const std::size_t n = origins.size() / 3;
    std::vector<std::uint32_t> counts(n);
    scene.count({origins, directions}, counts);
    const AllHits all = scene.all({origins, directions});
    ASSERT_EQ(all.splits.size(), n + 1);
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_EQ(counts[i] % 2, 0u) << "seed " << kSeed << ", ray " << i;
      ASSERT_LE(counts[i], 2u);
      ASSERT_EQ(all.splits[i + 1] - all.splits[i], counts[i]);
      for (std::uint64_t k = all.splits[i]; k < all.splits[i + 1]; ++k) {
        // Each lies on the cube's surface.
        double most = 0;
        for (std::size_t c = 0; c < 3; ++c)
          most = std::max(most, std::abs(origins[3 * i + c] + all.t[k] * directions[3 * i + c] - center[c]));
        EXPECT_NEAR(most, 1, 1e-6);
        EXPECT_LT(all.primitive[k], 12u);
      }
    }
  }
}

TEST_P(Query, CrossingsKnowMasksAndRaysThatMeanNothing) {
  const Cube cube;
  Scene scene;
  scene.add_mesh({cube.at(0, 0, 0), cube.triangles}, {.mask = 1});
  const GeometryId other = scene.add_mesh({cube.at(0, 0, 4), cube.triangles}, {.mask = 2});
  scene.commit(options());
  const std::vector<float> from = {0.25f, 0.1f, 9}, down = {0, 0, -1};
  const std::vector<std::uint32_t> masks = {0, 1, 2, 3};
  std::vector<std::uint32_t> counts(4);
  scene.count({from, down, {}, {}, masks}, counts);
  EXPECT_EQ(counts, (std::vector<std::uint32_t>{0, 2, 2, 4}));
  const AllHits all = scene.all({from, down, {}, {}, masks});
  EXPECT_EQ(all.splits, (std::vector<std::uint64_t>{0, 0, 2, 4, 8}));
  EXPECT_EQ(all.geometry, (std::vector<std::uint32_t>{0, 0, other, other, other, other, 0, 0}));
  EXPECT_EQ(all.t, (std::vector<double>{8, 10, 4, 6, 4, 6, 8, 10}));
  AllHitsOptions first;
  first.max_hits = 1;
  const AllHits nearest = scene.all({from, down, {}, {}, masks}, first);
  EXPECT_EQ(nearest.splits, (std::vector<std::uint64_t>{0, 0, 1, 2, 3}));
  EXPECT_EQ(nearest.more, (std::vector<std::uint8_t>{0, 1, 1, 1}));

  // Rays of doubles that begin near a surface are the host's, which knows masks of no bit as well.
  scene.set_mask(0, 0);
  scene.commit(options());
  counts.resize(3);
  const std::vector<double> near = {0.25, 0.1, 1, 0.25, 0.1, 1.000001, 0.25, 0.1, -1.000001};
  const std::vector<double> below = {0, 0, -1};
  std::vector<double> t(3);
  scene.count({near, below}, counts);
  EXPECT_EQ(counts, (std::vector<std::uint32_t>{0, 0, 0}));
  EXPECT_TRUE(scene.all({near, below}).t.empty());
  scene.closest({near, std::vector<double>{0, 0, 1}}, {.t = t});
  EXPECT_EQ(t, (std::vector<double>{2, 2 - 1e-6, 4 + 1e-6})) << "the cube that is seen";

  const std::vector<float> nowhere = {0, 0, 0};
  AllHitsOptions counted;
  counted.invalid = InvalidRays::miss;
  EXPECT_EQ(scene.all({from, nowhere}, counted).report.invalid, 1u);
  counts.resize(1);
  EXPECT_TRUE(fails([&] { scene.count({from, nowhere}, counts); }, "ray 0: its direction is 0"));
}

TEST_P(Query, PointsKnowWhatIsNearAndWhetherTheyAreInside) {
  constexpr unsigned kSeed = 6;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> anywhere(-3, 3);
  for (const std::array<double, 3>& center :
       {std::array<double, 3>{0, 0, 0}, {500'000.125, 4'649'776.25, 312.5}}) {
    const Scene scene = cube_at(center, 1);
    constexpr std::size_t kPoints = 50'000;
    std::vector<double> points;
    for (std::size_t i = 0; i < 3 * kPoints; ++i) points.push_back(center[i % 3] + anywhere(random));
    std::vector<double> distance(kPoints), sign(kPoints);
    std::vector<std::uint8_t> inside(kPoints);
    std::vector<std::uint32_t> geometry(kPoints), primitive(kPoints);
    std::vector<std::array<double, 3>> nearest(kPoints);
    scene.closest_points(
        points, {.distance = distance, .point = nearest, .geometry = geometry, .primitive = primitive});
    scene.inside(points, inside);
    scene.signed_distance(points, sign);
    for (std::size_t i = 0; i < kPoints; ++i) {
      // The cube's own formula, of the coordinates less the centre (exact).
      double out2 = 0, most = -3, step2 = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double x = std::abs(points[3 * i + k] - center[k]);
        out2 += std::pow(std::max(x - 1, 0.0), 2);
        most = std::max(most, x - 1);
        step2 += std::pow(nearest[i][k] - points[3 * i + k], 2);
      }
      const double expected = most <= 0 ? most : std::sqrt(out2);
      ASSERT_EQ(inside[i], most < 0) << "seed " << kSeed << ", point " << i;
      ASSERT_NEAR(sign[i], expected, 4e-16 * std::max(1.0, std::abs(expected)) + 1e-15) << i;
      ASSERT_EQ(distance[i], std::abs(sign[i]));
      ASSERT_NEAR(std::sqrt(step2), distance[i], 2e-9);
      ASSERT_EQ(geometry[i], 0u);
      ASSERT_LT(primitive[i], 12u);
    }
  }
}

TEST_P(Query, PointsThatAreNotFiniteAreRefusedOrCounted) {
  const Scene scene = cube_at({0, 0, 0}, 1);
  const std::vector<double> points = {0, 0, 0, 0, std::numeric_limits<double>::quiet_NaN(), 0, 0, 0, 9};
  std::vector<double> distance(3);
  EXPECT_TRUE(fails([&] { scene.signed_distance(points, distance); }, "point 1"));
  PointOptions options;
  options.invalid = InvalidRays::miss;
  options.radius = 5;
  EXPECT_EQ(scene.signed_distance(points, distance, options).invalid, 1u);
  EXPECT_EQ(distance[0], -1);
  EXPECT_TRUE(std::isnan(distance[1]));
  EXPECT_EQ(distance[2], kInfinity) << "beyond the radius";
  std::vector<std::uint8_t> inside(3);
  scene.inside(points, inside, options);
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{1, 0, 0}));
}

// Sizes and lengths at the ends of float's range, which doubles hold: the same cube, scaled by powers of two.
TEST_P(Query, DoublesAreAnsweredBeyondTheRangeOfFloats) {
  for (const int size : {-300, -130, 0, 130, 300}) {
    const Scene scene = cube_at({0, 0, 0}, std::ldexp(1.0, size));
    for (const int length : {-200, -40, 0, 40, 200}) {
      SCOPED_TRACE(std::to_string(size) + ", " + std::to_string(length));
      const double unit = std::ldexp(1.0, size), step = std::ldexp(1.0, length);
      const std::vector<double> from = {0.25 * unit, 0.1 * unit, 1.75 * unit}, down = {0, 0, -step};
      std::vector<double> t(1);
      scene.closest({from, down}, {.t = t});
      EXPECT_EQ(t[0], std::ldexp(0.75, size - length));
      const AllHits all = scene.all({from, down});
      EXPECT_EQ(all.t,
                (std::vector<double>{std::ldexp(0.75, size - length), std::ldexp(2.75, size - length)}));
    }
  }
}

TEST_P(Query, RaysAndPointsFromBeyondAllAreNoErrors) {
  const Scene scene = cube_at({0, 0, 0}, 1);
  const std::vector<double> from = {1e300, 0.25, 0.125, 0.25, 0.125, 5}, along = {-1, 0, 0, 0, 0, -1};
  const std::vector<double> late = {0, 1e300};  // the second begins behind everything
  std::vector<std::uint32_t> counts(2, 9);
  scene.count({from, along, late}, counts);
  EXPECT_EQ(counts[1], 0u);
  const std::vector<double> points = {1e300, 0, 0, 0, 0, 0.5};
  std::vector<std::uint8_t> inside(2, 9);
  scene.inside(points, inside);
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{0, 1}));
  std::vector<double> distance(2);
  scene.signed_distance(points, distance);
  EXPECT_EQ(distance, (std::vector<double>{1e300, -0.5}));
}

// t below 0 is on the line as well.
TEST_P(Query, HitsBehindAFarOriginAreFound) {
  const Scene scene = cube_at({0, 0, 0}, 1);
  const std::vector<double> from = {0.25, 0.125, 1e6}, up = {0, 0, 1}, first = {-2e6};
  std::vector<double> t(1);
  scene.closest({from, up, first}, {.t = t});
  EXPECT_NEAR(t[0], -1e6 - 1, 1e-6);
}

TEST_P(Query, ArraysOfNoWholeRowsAndRowsThatOverlapAreRefused) {
  const Scene scene = cube_at({0, 0, 0}, 1);
  const std::vector<double> seven(7, 1.0);
  std::vector<double> t(2);
  EXPECT_TRUE(fails(
      [&] {
        scene.closest({seven, seven}, {.t = t});
      },
      "7 values is no whole number of rows of 3"));
  EXPECT_TRUE(fails([&] { HitsOut{.t = {t.data(), 2, 4}}; }, "4 bytes apart"));
}

}  // namespace
}  // namespace kdray
