// What every kind but triangles owes to `kdray verify`: places to aim at, hits that are certain, and whether
// a hit is one of what the ray has just left; against the oracle, on scenes of one primitive.
#include <algorithm>
#include <cmath>

#include "conformance/all_kinds.h"
#include "oracle/primitives.h"

namespace kdray::test {
namespace {

constexpr std::uint64_t kSeed = 20261125;
constexpr int kScenes = 200;

// One shape, as the file, the tree and the oracle have it.
template <class Kind>
struct One {
  scene::Scene scene;
  scene::Geometry geometry = scene::make_geometry(scene);
  oracle::World world{scene};

  const auto& shape() const { return Kind::of(geometry)[0]; }
  const LocalSpace& space() const { return geometry.space; }
  primitives::Line local(const oracle::Ray& ray) const {
    return {space().local(ray.origin), ray.direction * space().scale};  // t is the same
  }
};

template <class Kind>
class ExactOf : public testing::Test {
 protected:
  template <class Check>
  void for_each_one(const Check& check) {
    for (int i = 0; i < kScenes && !testing::Test::HasFailure(); ++i) {
      SCOPED_TRACE(testing::Message() << "scene " << i << ", seed " << kSeed);
      check(One<Kind>{scene_of<Kind>(1, kSeed + static_cast<std::uint64_t>(i))});
    }
  }
  // From somewhere about the shape to a place of it.
  oracle::Ray aimed(const One<Kind>& one) {
    const dvec3 place = place_on(one.shape(), random_.between(0, 1), random_.direction());
    const dvec3 from = 3.0 * random_.direction();
    return {.origin = from, .direction = one.space().world(place) - from};
  }

  Draw random_{kSeed};
};
TYPED_TEST_SUITE(ExactOf, AllShapes, KindNames);

TYPED_TEST(ExactOf, PlacesAreAllOverIt) {
  this->for_each_one([&](const auto& one) {
    const Box bounds = bounds_of(one.shape());
    DBox places;
    for (int i = 0; i < 200; ++i)
      places.grow(place_on(one.shape(), this->random_.between(0, 1), this->random_.direction()));
    const dvec3 slack(1e-4 * glm::length(dvec3(bounds.extent())));
    EXPECT_TRUE(glm::all(glm::lessThanEqual(dvec3(bounds.lo) - slack, places.lo)) &&
                glm::all(glm::lessThanEqual(places.hi, dvec3(bounds.hi) + slack)));
    EXPECT_GT(glm::length(places.extent()), 0.5 * glm::length(dvec3(bounds.extent())));
  });
}

// What is certain is so, and much is.
TYPED_TEST(ExactOf, SureTargetsAreMet) {
  int sure = 0, n = 0;
  this->for_each_one([&](const auto& one) {
    for (int i = 0; i < 50; ++i, ++n) {
      const oracle::Ray ray = this->aimed(one);
      const double margin = 1e-6 * glm::length(dvec3(one.geometry.bounds.extent()));
      const std::optional<double> t = sure_target(one.local(ray), one.shape(), margin);
      if (!t || *t <= 0) continue;
      ++sure;
      const oracle::Hit met = one.world.closest(ray);
      EXPECT_TRUE(met.found());
      EXPECT_NEAR(met.t, *t, 1e-4);
    }
  });
  EXPECT_EQ(sure > n / 4, kIsSureOfTargets<TypeParam>) << sure << " of " << n;
}

// A ray that leaves along the normal cannot have the surface close before it; one that comes back can. (But
// within a tip, which is narrower than these rays are long.)
TYPED_TEST(ExactOf, KnowsWhatARayHasLeft) {
  // Far enough that the rounding of the tree's floats is no matter.
  constexpr double kOff = 1e-4, kNear = 1e-3;
  int met = 0, again = 0, wrongly = 0;
  this->for_each_one([&](const auto& one) {
    for (int i = 0; i < 20; ++i) {
      const oracle::Ray ray = this->aimed(one);
      const oracle::Hit hit = one.world.closest(ray);
      if (!hit.found()) continue;
      ++met;
      const oracle::Surface surface = one.world.surface(ray, hit);
      const bool from_inside = glm::dot(surface.outward, ray.direction) > 0;
      const dvec3 side = from_inside ? -surface.outward : surface.outward;
      const auto meets = [&](double off, const dvec3& direction) {
        const oracle::Ray leaving{.origin = surface.point + off * side, .direction = direction};
        return meets_again(one.local(leaving), one.shape(), kNear, side) ? 1 : 0;
      };
      again += meets(kOff, side), wrongly += meets(kNear, -side);
    }
  });
  EXPECT_GT(met, 500);
  EXPECT_GE(again, 0.98 * met);
  EXPECT_LE(wrongly, 0.02 * met);
}

// Across the hole a ray may meet the torus that it has left, through the axis itself too; nearer by it may
// not.
TEST(ExactOfATorus, ItIsMetAgainAcrossItsHole) {
  const scene::TorusGeometry torus{{0, 0, 0}, {0, 0, 1}, 1, 0.25f, 0};
  for (const double aside : {0.0, 1e-12, 0.01}) {
    const primitives::Line across{{0.75 - 1e-6, 0, 0}, {-1, aside, 0}};
    EXPECT_FALSE(meets_again(across, torus, 1.5, {-1, 0, 0})) << aside;
    EXPECT_TRUE(meets_again(across, torus, 1e-3, {-1, 0, 0})) << aside;
  }
  const primitives::Line within{{1.25 - 1e-6, 0, 0}, {-1, 0, 0}};
  EXPECT_FALSE(meets_again(within, torus, 0.5, {-1, 0, 0}));
  EXPECT_TRUE(meets_again(within, torus, 1e-3, {-1, 0, 0}));
}

// From inside it may come out where it is nearer to the surface than rounding, though it passes below.
TEST(ExactOfATorus, ItIsMetAgainWhereItIsTouchedFromWithin) {
  const scene::TorusGeometry torus{{0, 0, 0}, {0, 0, 1}, 1, 0.25f, 0};
  for (const double below : {1e-6, 1e-3}) {
    const primitives::Line touching{{0.75 + below, -0.3, 0}, {0, 1, 0}};
    EXPECT_EQ(meets_again(touching, torus, 0.3, {1, 0, 0}), below > 1e-5) << below;
    EXPECT_TRUE(meets_again(touching, torus, 1e-3, {1, 0, 0})) << below;
  }
}

}  // namespace
}  // namespace kdray::test
