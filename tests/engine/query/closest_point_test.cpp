// Closest points against exact arithmetic, and what is promised of them whatever the tree and the device's
// vectors.
#include "engine/query/point_session.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "engine/query/closest_judge.h"
#include "engine/query/closest_scenes.h"
#include "engine/query/device_scene.h"
#include "engine/query/exact_distance.h"
#include "support/device.h"
#include "support/errors.h"

namespace kdray::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void expect_exact(const std::string& name, const scene::Scene& scene, const std::string& device,
                  std::size_t n, const std::string& build_options = "", const Promise& promise = kInDoubles) {
  set_exact_precision();
  DeviceScene queried(scene, device, build_options);
  const std::vector<dvec3> points = points_for(queried, n);
  const query::ClosestPoints answers = query::closest_points(queried.target(), points, kInfinity);
  ASSERT_EQ(answers.points.size(), points.size());
  Judge judge(queried, promise);
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    if (!testing::Test::HasFailure()) judge.judge(i, points[i], answers.points[i]);
  });
  judge.errors.print(name);
}

class ClosestPoints : public EachDevice {
 protected:
  static constexpr std::size_t kPoints = 10000;
};

TEST_P(ClosestPoints, OfTrianglesAreExact) {
  expect_exact("triangles", soup(300, 1), GetParam(), kPoints);
  expect_exact("of all sizes", soup(300, 7), GetParam(), kPoints);
  expect_exact("slivers", slivers(300), GetParam(), kPoints);
  expect_exact("one", soup(1, 0), GetParam(), kPoints);
}

TEST_P(ClosestPoints, OfSharedCornersAndEdgesAreTheSmallestNumber) {
  expect_exact("grid", grid(12), GetParam(), kPoints);
  expect_exact("grid far off", moved(grid(12), 0.25, {4096, -8192, 2048}), GetParam(), kPoints);
  expect_exact("ball", ball(12), GetParam(), kPoints);
}

TEST_P(ClosestPoints, OfScenesOfAnySizeAndPlaceAreExact) {
  expect_exact("tiny", moved(soup(200, 2), 1e-30, dvec3(0)), GetParam(), kPoints);
  expect_exact("huge", moved(soup(200, 2), 1e30, dvec3(0)), GetParam(), kPoints);
  expect_exact("far off", moved(soup(200, 2), 1, {1e6, -3e6, 2e5}), GetParam(), kPoints);
}

TEST_P(ClosestPoints, OfShapesAreExact) {
  primitives::for_each_shape(
      [&](auto kind) { expect_exact(kind.kNames, shapes<decltype(kind)>(200), GetParam(), kPoints); });
  expect_exact("flat cones", flat_cones(200), GetParam(), kPoints);
  expect_exact("all kinds", all_kinds(), GetParam(), kPoints);
}

// What devices without doubles do.
TEST_P(ClosestPoints, InPairsOfFloatsAreRightToAFloatsLastPlaces) {
  const std::string floats = "-DKDRAY_PRECISE=32";
  expect_exact("triangles in floats", soup(300, 1), GetParam(), kPoints / 4, floats, kInPairsOfFloats);
  expect_exact("grid in floats", grid(12), GetParam(), kPoints / 4, floats, kInPairsOfFloats);
  expect_exact("all kinds in floats", all_kinds(), GetParam(), kPoints / 4, floats, kInPairsOfFloats);
}

KDRAY_FOR_EACH_DEVICE(ClosestPoints);

}  // namespace
}  // namespace kdray::test
