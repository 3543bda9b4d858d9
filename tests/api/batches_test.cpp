// Queries in batches of any size: what is asked alone, in a few or among many, in any form of arrays, has the
// same answer, bit for bit; and what was refused leaves nothing behind.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "kdray/kdray.h"
#include "support/device.h"
#include "support/errors.h"

namespace kdray {
namespace {

using test::fails;

constexpr unsigned kSeed = 25;

class Batches : public test::EachDevice {
 protected:
  // A lump of triangles about a centre far from the origin, in two geometries.
  Scene lumps(bool masked) const {
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<float> anywhere(-1, 1), near(-0.3f, 0.3f);
    Scene scene;
    for (const std::uint32_t mask : {1u, 3u}) {
      std::vector<float> vertices;
      std::vector<std::uint32_t> triangles;
      for (int i = 0; i < 400; ++i) {
        const float at[3] = {anywhere(random), anywhere(random), anywhere(random)};
        for (int corner = 0; corner < 3; ++corner)
          for (int k = 0; k < 3; ++k) vertices.push_back(kCenter[k] + at[k] + near(random));
        for (std::uint32_t k = 0; k < 3; ++k) triangles.push_back(3 * static_cast<std::uint32_t>(i) + k);
      }
      scene.add_mesh({vertices, triangles}, {.mask = masked ? mask : ~0u});
    }
    CommitOptions options;
    options.device.device = GetParam();
    scene.commit(options);
    return scene;
  }

  static constexpr float kCenter[3] = {1000.5f, -2000.25f, 300};
};
KDRAY_FOR_EACH_DEVICE(Batches);

// Separate arrays; every `odd_lengths`th direction is very long or short.
struct Arrays {
  std::vector<float> origins, directions, t_min, t_max;
  std::vector<std::uint32_t> masks;

  Arrays(std::size_t n, const float (&center)[3], std::size_t odd_lengths) {
    std::mt19937 random(kSeed + 1);
    std::uniform_real_distribution<float> anywhere(-1.5f, 1.5f);
    for (std::size_t i = 0; i < n; ++i) {
      const float length = odd_lengths > 0 && i % odd_lengths == 0 ? (i % 2 ? 1e-5f : 1e5f) : 1;
      for (const float c : center) origins.push_back(c + anywhere(random));
      for (int k = 0; k < 3; ++k) directions.push_back(length * anywhere(random));
      t_min.push_back(std::max(0.0f, 0.2f * anywhere(random) / length));
      t_max.push_back(i % 3 == 0 ? std::numeric_limits<float>::infinity() : 2 / length);
      masks.push_back(static_cast<std::uint32_t>(i % 4));
    }
  }
  std::size_t size() const { return t_min.size(); }
  Rays some(std::size_t first, std::size_t n) const {
    return {Points(&origins[3 * first], n), Points(&directions[3 * first], n), Values(&t_min[first], n),
            Values(&t_max[first], n), Words(&masks[first], n)};
  }
  Points points(std::size_t first, std::size_t n) const { return Points(&origins[3 * first], n); }
};

struct Hits {
  std::vector<float> t, u, v;
  std::vector<std::uint32_t> geometry, primitive;
  explicit Hits(std::size_t n) : t(n), u(n), v(n), geometry(n), primitive(n) {}
  HitsOut some(std::size_t first, std::size_t n) {
    return {.t = ValuesOut(&t[first], n),
            .geometry = WordsOut(&geometry[first], n),
            .primitive = WordsOut(&primitive[first], n),
            .u = ValuesOut(&u[first], n),
            .v = ValuesOut(&v[first], n)};
  }
  bool operator==(const Hits&) const = default;
};

// Sizes of batches: alone, a few, and more than are sorted, packed or copied like a few.
constexpr std::size_t kSizes[] = {1, 3, 70, 5000};

TEST_P(Batches, RaysHaveTheSameHitsAloneAndAmongMany) {
  for (const bool masked : {false, true}) {
    SCOPED_TRACE(masked);
    const Scene scene = lumps(masked);
    const Arrays rays(20'000, kCenter, masked ? 0 : 7);
    Hits whole(rays.size());
    std::vector<std::uint8_t> any(rays.size());
    std::vector<std::uint32_t> count(rays.size());
    scene.closest(rays.some(0, rays.size()), whole.some(0, rays.size()));
    scene.any(rays.some(0, rays.size()), any);
    scene.count(rays.some(0, rays.size()), count);
    const AllHits all = scene.all(rays.some(0, rays.size()));
    ASSERT_GT(all.t.size(), rays.size() / 2) << "some meet several things";
    for (const std::size_t size : kSizes)
      for (std::size_t first = 0; first < std::min<std::size_t>(rays.size(), 60 * size); first += size) {
        Hits part(size), expected(size);
        scene.closest(rays.some(first, size), part.some(0, size));
        std::vector<std::uint8_t> part_any(size);
        std::vector<std::uint32_t> part_count(size);
        scene.any(rays.some(first, size), part_any);
        scene.count(rays.some(first, size), part_count);
        const AllHits part_all = scene.all(rays.some(first, size));
        for (std::size_t i = 0; i < size; ++i) {
          ASSERT_EQ(part.t[i], whole.t[first + i]) << "seed " << kSeed << ", ray " << first + i;
          ASSERT_EQ(part.u[i], whole.u[first + i]);
          ASSERT_EQ(part.v[i], whole.v[first + i]);
          ASSERT_EQ(part.geometry[i], whole.geometry[first + i]);
          ASSERT_EQ(part.primitive[i], whole.primitive[first + i]);
          ASSERT_EQ(part_any[i], any[first + i]);
          ASSERT_EQ(part_count[i], count[first + i]);
          const std::size_t at = part_all.splits[i], from = all.splits[first + i];
          ASSERT_EQ(part_all.splits[i + 1] - at, all.splits[first + i + 1] - from);
          for (std::size_t k = 0; k < part_all.splits[i + 1] - at; ++k) {
            ASSERT_EQ(part_all.t[at + k], all.t[from + k]) << first + i;
            ASSERT_EQ(part_all.u[at + k], all.u[from + k]);
            ASSERT_EQ(part_all.v[at + k], all.v[from + k]);
            ASSERT_EQ(part_all.geometry[at + k], all.geometry[from + k]);
            ASSERT_EQ(part_all.primitive[at + k], all.primitive[from + k]);
          }
        }
      }
  }
}

// Rays that end in one place, as those towards a light do, and end behind their starts.
TEST_P(Batches, AnyHitsBehindTheStartAreThoseOfClosestHits) {
  const Scene scene = lumps(false);
  std::mt19937 random(kSeed + 2);
  std::uniform_real_distribution<float> anywhere(-1, 1), near(-0.05f, 0.05f);
  constexpr std::size_t kEnds = 100, kRays = 64;
  std::vector<float> origins, directions;
  for (std::size_t end = 0; end < kEnds; ++end) {
    float at[3], way[3];
    for (int k = 0; k < 3; ++k) at[k] = kCenter[k] + anywhere(random), way[k] = anywhere(random);
    for (std::size_t i = 0; i < kRays; ++i)
      for (int k = 0; k < 3; ++k) {
        directions.push_back(way[k] + near(random));
        origins.push_back(at[k] + directions.back());  // at t = -1 they are where all of them end
      }
  }
  const std::vector<float> t_min{-2}, t_max{-1};
  const Rays rays{origins, directions, t_min, t_max};
  std::vector<float> t(kEnds * kRays);
  std::vector<std::uint8_t> any(kEnds * kRays);
  scene.closest(rays, {.t = t});
  scene.any(rays, any);
  for (std::size_t i = 0; i < t.size(); ++i) ASSERT_EQ(any[i], std::isfinite(t[i])) << i;
  EXPECT_GT(std::ranges::count(any, 1), 1000);
}

TEST_P(Batches, PointsHaveTheSameAnswersAloneAndAmongMany) {
  const Scene scene = lumps(true);
  const Arrays points(20'000, kCenter, 0);
  const std::size_t n = points.size();
  std::vector<double> distance(n), with_sign(n), place(3 * n);
  std::vector<std::uint8_t> inside(n);
  scene.closest_points(points.points(0, n), {.distance = distance, .point = place});
  scene.signed_distance(points.points(0, n), with_sign);
  scene.inside(points.points(0, n), inside);
  for (const std::size_t size : kSizes)
    for (std::size_t first = 0; first < std::min<std::size_t>(n, 60 * size); first += size) {
      std::vector<double> part(size), part_sign(size), part_place(3 * size);
      std::vector<std::uint8_t> part_inside(size);
      scene.closest_points(points.points(first, size), {.distance = part, .point = part_place});
      scene.signed_distance(points.points(first, size), part_sign);
      scene.inside(points.points(first, size), part_inside);
      for (std::size_t i = 0; i < size; ++i) {
        ASSERT_EQ(part[i], distance[first + i]) << "seed " << kSeed << ", point " << first + i;
        ASSERT_EQ(part_sign[i], with_sign[first + i]);
        ASSERT_EQ(std::abs(part_sign[i]), part[i]);
        ASSERT_EQ(part_inside[i], inside[first + i]);
        ASSERT_EQ(part_inside[i] != 0, std::signbit(part_sign[i]));
        for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(part_place[3 * i + k], place[3 * (first + i) + k]);
      }
    }
}

TEST_P(Batches, FloatsAreTakenAsDoublesAreAndGivenInAnyForm) {
  const Scene scene = lumps(false);
  const Arrays rays(4099, kCenter, 0);  // no whole number of fours
  const std::size_t n = rays.size();
  const std::vector<double> origins(rays.origins.begin(), rays.origins.end()),
      directions(rays.directions.begin(), rays.directions.end());
  std::vector<float> t(n), u(n), double_u(n);
  std::vector<double> double_t(n);
  std::vector<std::uint32_t> primitive(n), apart(2 * n);
  const Values t_min(rays.t_min), t_max(rays.t_max);
  scene.closest({rays.origins, rays.directions, t_min, t_max}, {.t = t, .primitive = primitive, .u = u});
  scene.closest({origins, directions, t_min, t_max},
                {.t = double_t, .primitive = {apart.data(), n, 8}, .u = double_u});
  for (std::size_t i = 0; i < n; ++i) {
    // They meet the same; t of doubles is found in double.
    ASSERT_EQ(std::isinf(t[i]), std::isinf(double_t[i])) << "seed " << kSeed << ", ray " << i;
    ASSERT_TRUE(std::isinf(t[i]) || std::abs(t[i] - double_t[i]) <= 1e-5 * double_t[i] + 1e-6) << "ray " << i;
    ASSERT_EQ(primitive[i], apart[2 * i]) << i;
    ASSERT_EQ(u[i], double_u[i]) << i;
  }
  // All from one place, at once and one by one.
  scene.closest({Points(rays.origins.data(), 1), rays.directions}, {.t = t});
  for (std::size_t i = 0; i < 100; ++i) {
    float alone = 0;
    scene.closest({Points(rays.origins.data(), 1), Points(&rays.directions[3 * i], 1)}, {.t = {&alone, 1}});
    ASSERT_EQ(alone, t[i]) << i;
  }
}

// So many rays that others are being traced when the one that means nothing is found.
TEST_P(Batches, ARefusedRayLeavesNothingBehind) {
  const Scene scene = lumps(false);
  Arrays rays(300'000, kCenter, 0);
  std::vector<float> expected(rays.size()), t(rays.size());
  scene.closest(rays.some(0, rays.size()), {.t = expected});
  for (const std::size_t bad : {std::size_t{0}, std::size_t{150'001}, rays.size() - 1}) {
    const float before = std::exchange(rays.directions[3 * bad + 1], std::numeric_limits<float>::quiet_NaN());
    const std::string name = "ray " + std::to_string(bad) + ":";
    EXPECT_TRUE(fails([&] { scene.closest(rays.some(0, rays.size()), {.t = t}); }, name));
    EXPECT_TRUE(fails([&] { scene.count(rays.some(0, rays.size()), {}); }, name));
    const QueryReport report =
        scene.closest(rays.some(0, rays.size()), {.t = t}, {.invalid = InvalidRays::miss});
    EXPECT_EQ(report.invalid, 1u);
    EXPECT_TRUE(std::isinf(t[bad]));
    t[bad] = expected[bad];
    EXPECT_EQ(t, expected) << "seed " << kSeed;
    rays.directions[3 * bad + 1] = before;
  }
}

}  // namespace
}  // namespace kdray
