// What    Which hits count: those between t_min and t_max, and those in the start point where t_min is 0; for
//         directions of any length, rays from far off, and scenes that no float can scale to their size.
#include <cmath>

#include "engine/query/meshes.h"
#include "engine/query/queried_scene.h"

namespace kdray::test {
namespace {

// The cube from -1 to 1, in the world's coordinates.
class Intervals : public OnDevice {
 protected:
  static QueriedScene& cube() {
    static QueriedScene queried(stress::cube(), Space::worlds);
    return queried;
  }
  static std::uint32_t count(const Ray& ray) { return cube().count({&ray, 1})[0]; }
  static std::vector<float> distances(const Ray& ray) {
    const query::LocalHits all = cube().all({&ray, 1});
    return {all.t.begin(), all.t.end()};
  }
};

TEST_F(Intervals, AreOpen) {
  const vec3 o(0.25f, 0.5f, -3), d(0, 0, 1);  // hits at 2 and 4
  EXPECT_EQ(distances(ray_from(o, d)), (std::vector<float>{2, 4}));
  EXPECT_EQ(distances(ray_from(o, d, 2)), std::vector<float>{4});
  EXPECT_EQ(distances(ray_from(o, d, std::nextafter(2.0f, 0.0f))), (std::vector<float>{2, 4}));
  EXPECT_EQ(distances(ray_from(o, d, 0, 4)), std::vector<float>{2});
  EXPECT_EQ(distances(ray_from(o, d, 0, std::nextafter(4.0f, 5.0f))), (std::vector<float>{2, 4}));
  EXPECT_EQ(count(ray_from(o, d, 5)), 0);
  EXPECT_EQ(count(ray_from(o, d, 0, -1)), 0);
  EXPECT_EQ(count(ray_from(o, d, 3, 3)), 0);
  EXPECT_EQ(count(ray_from(o, d, 4, 2)), 0);
  // These lie behind the start.
  EXPECT_EQ(distances(ray_from(o, -d, -1e30f)), (std::vector<float>{-4, -2}));
  EXPECT_EQ(distances(ray_from({0.25f, 0.5f, 0}, d, -5)), (std::vector<float>{-1, 1}));
  EXPECT_EQ(distances(ray_from({0.25f, 0.5f, 0}, d, -5, 0)), std::vector<float>{-1});
}

TEST_F(Intervals, HoldTheStartPointWhereTheyBeginAt0) {
  const vec3 on_face(0.25f, 0.5f, -1), d(0, 0, 1);
  EXPECT_EQ(distances(ray_from(on_face, d)), (std::vector<float>{0, 2}));
  EXPECT_EQ(distances(ray_from(on_face, d, -0.0f)), (std::vector<float>{0, 2}));
  EXPECT_EQ(distances(ray_from(on_face, -d)), std::vector<float>{0});
  EXPECT_EQ(distances(ray_from(on_face, d, -1e-30f)), (std::vector<float>{0, 2}));
  // In the scene's own space some of these are 0 as well.
  for (const float t_min : {1e-45f, 1e-38f, 1e-20f, 1.0f})
    EXPECT_EQ(distances(ray_from(on_face, d, t_min)), std::vector<float>{2}) << t_min;
  EXPECT_EQ(distances(ray_from(on_face, d, 0, 0)), std::vector<float>{});
  EXPECT_EQ(distances(ray_from(on_face, d, -1, 1)), std::vector<float>{0});
}

// t counts in multiples of the direction.
TEST_F(Intervals, CountInMultiplesOfTheDirection) {
  for (const float length : {1e-38f, 1e-30f, 1e-6f, 1.0f, 1e6f, 1e37f}) {
    const Ray ray = ray_from({0.25f, 0.5f, -3}, vec3(0, 0, length), 0, 3 / length);
    const std::vector<float> t = distances(ray);
    ASSERT_EQ(t.size(), 1) << length;
    EXPECT_NEAR(t[0] * length, 2, 1e-5) << length;
    EXPECT_EQ(count(ray_from({0.25f, 0.5f, -3}, vec3(0, 0, length))), 2);
  }
}

TEST_F(Intervals, ReachFarRays) {
  for (const float far : {1e6f, 1e20f, 1e30f}) {
    const std::vector<float> t = distances(ray_from({0, 0.25f, -far}, {0, 0, far}));
    ASSERT_EQ(t.size(), 2) << far;
    EXPECT_NEAR(t[0], 1, 1e-5);
    EXPECT_NEAR(t[1], 1, 1e-5);
    EXPECT_LE(t[0], t[1]);
    EXPECT_EQ(count(ray_from({0, 0.25f, -far}, {0, 0, far}, 0, 0.5f)), 0);
  }
}

// What was done to one chunk's rays isn't done to the next one's.
TEST_F(Intervals, ReachFarRaysBesideOthers) {
  std::vector<Ray> rays(200000, ray_from({0.25f, 0.5f, -3}, {0, 0, 1}));
  for (const std::size_t i : {0u, 1u, 70000u, 199999u}) rays[i] = ray_from({0, 0.25f, -1e30f}, {0, 0, 1e30f});
  const query::LocalHits all = cube().all(rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(all.splits[i + 1] - all.splits[i], 2) << i;
    const bool far = rays[i].origin[2] < -3;
    ASSERT_NEAR(all.t[all.splits[i]], far ? 1 : 2, 1e-5) << i;
    ASSERT_NEAR(all.t[all.splits[i] + 1], far ? 1 : 4, 1e-5) << i;
  }
}

TEST_F(Intervals, ReachScenesThatNoFloatScales) {
  for (const double scale : {1e-36, 1e36}) {
    QueriedScene queried(stress::placed(stress::cube(), scale, dvec3(0)), Space::worlds);
    const auto s = static_cast<float>(scale);
    const Ray ray = ray_from({0.25f * s, 0.5f * s, -3 * s}, {0, 0, s});
    const query::LocalHits all = queried.all({&ray, 1});
    ASSERT_EQ(all.t.size(), 2) << scale;
    EXPECT_NEAR(all.t[0], 2, 1e-5);
    EXPECT_NEAR(all.t[1], 4, 1e-5);
  }
}

}  // namespace
}  // namespace kdray::test
