// What    every kind owes to points: no place of its surface is closer than what is found, and what is found
//         is a place of it.
// Held against random places of the surface, as other tests of a kind are; tests/engine/query has exact
// arithmetic.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "conformance/all_kinds.h"
#include "engine/query/device_scene.h"
#include "engine/query/point_session.h"
#include "support/device.h"

namespace kdray::test {
namespace {

constexpr std::uint64_t kSeed = 20261124;
constexpr int kPrimitives = 25, kSamples = 2500;
constexpr double kRounding =
    4e-6;                         // of the scene, whose size is 3, to floats; of cones again, to the kernels'
constexpr double kSpacing = 0.1;  // more than between places of a primitive

struct SurfacePlace {
  dvec3 world;
  std::int32_t number;
};

template <class Kind>
class ClosestOf : public testing::Test {
 protected:
  void SetUp() override {
    if (usable_devices().empty()) GTEST_SKIP() << "no OpenCL device";
  }

  std::vector<SurfacePlace> places() {
    const scene::Geometry geometry = scene::make_geometry(scene_);
    std::vector<SurfacePlace> places;
    for (const auto& primitive : Kind::of(geometry))
      for (int i = 0; i < kSamples; ++i)
        places.push_back(
            {geometry.space.world(dvec3(Samples<Kind>::point(primitive, random_))), number_of(primitive)});
    return places;
  }
  std::vector<dvec3> points(std::size_t n) {
    std::vector<dvec3> points(n);
    for (dvec3& p : points) p = random_.in_cube(random_.below(3) == 0 ? 4 : 1.3);
    return points;
  }

  scene::Scene scene_ = scene_of<Kind>(kPrimitives, kSeed);
  Draw random_{kSeed + 2};

 private:
  std::int32_t number_of(const auto& primitive) const {
    if constexpr (Kind::kIsShape)
      return static_cast<std::int32_t>(Kind::of(scene_)[primitive.source].number);
    else
      return static_cast<std::int32_t>(primitive.number);
  }
};
TYPED_TEST_SUITE(ClosestOf, AllKinds, KindNames);

TYPED_TEST(ClosestOf, NoPlaceIsCloserThanTheClosest) {
  DeviceScene asked(this->scene_, usable_devices().front());
  const std::vector<dvec3> points = this->points(400);
  const std::vector<SurfacePlace> places = this->places();
  const std::vector<query::ClosestPoint> found =
      query::closest_points(asked.target(), points, std::numeric_limits<double>::infinity()).points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity(), of_found = nearest;
    for (const SurfacePlace& place : places) {
      const double distance = glm::length(place.world - points[i]);
      nearest = std::min(nearest, distance);
      if (place.number == found[i].primitive) of_found = std::min(of_found, distance);
    }
    ASSERT_LE(found[i].distance, nearest + kRounding) << "point " << i << ", seed " << kSeed;
    ASSERT_LE(of_found, found[i].distance + kSpacing) << "point " << i << ", seed " << kSeed;
    ASSERT_NEAR(glm::length(found[i].point - points[i]), found[i].distance, 1e-12) << "point " << i;
  }
}

// DeviceScene from there, it is no distance away; and from a place of the surface, only the scene's rounding.
TYPED_TEST(ClosestOf, PlacesOfItAreNoDistanceAway) {
  DeviceScene asked(this->scene_, usable_devices().front());
  const double anywhere = std::numeric_limits<double>::infinity();
  std::vector<dvec3> again;
  for (const query::ClosestPoint& p :
       query::closest_points(asked.target(), this->points(2000), anywhere).points)
    again.push_back(p.point);
  for (const query::ClosestPoint& p : query::closest_points(asked.target(), again, anywhere).points)
    ASSERT_LE(p.distance, 1e-12) << "seed " << kSeed;
  std::vector<dvec3> on;
  for (const SurfacePlace& place : this->places()) on.push_back(place.world);
  for (const query::ClosestPoint& p : query::closest_points(asked.target(), on, anywhere).points)
    ASSERT_LE(p.distance, kRounding) << "seed " << kSeed;
}

}  // namespace
}  // namespace kdray::test
