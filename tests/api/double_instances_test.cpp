// Instances in scenes of doubles: a copy of the prototype, whose corners are where the transform brings them,
// answers as a mesh of these corners does, which double_scene_test.cpp holds against rationals.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "api/double_oracle.h"
#include "kdray/kdray.h"
#include "support/device.h"

namespace kdray {
namespace {

using namespace test::doubles;
using test::Point;

constexpr unsigned kSeed = 460;
constexpr std::uint32_t kPlaces = 9;
constexpr std::uint32_t kOwnMask = 1, kPlacedMask = 2;

using Rows = std::array<double, 12>;

// Of few bits, so that vertices come to where they are without rounding; every other one mirrors.
std::vector<Rows> few_bits(std::mt19937& random) {
  std::uniform_int_distribution<int> shear(-16, 16), far(-4096, 4096);
  std::vector<Rows> places;
  for (std::uint32_t i = 0; i < kPlaces; ++i) {
    const double a = shear(random) / 32.0, b = shear(random) / 32.0, c = shear(random) / 32.0;
    const double x = far(random) / 1024.0, y = far(random) / 1024.0, z = far(random) / 1024.0;
    places.push_back({i % 2 == 0 ? 2.0 : -2.0, a, 0, x, 0, 1.5, b, y, c, 0, 1, z});
  }
  return places;
}

DoubleMesh few_bits(DoubleMesh mesh) {
  for (Point& p : mesh.vertices)
    for (double& x : p) x = std::ldexp(std::round(std::ldexp(x, 24)), -24);
  return mesh;
}

DoubleMesh moved(DoubleMesh mesh, const Rows& m) {
  for (Point& p : mesh.vertices) {
    const Point from = p;
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = m[4 * k] * from[0] + m[4 * k + 1] * from[1] + m[4 * k + 2] * from[2] + m[4 * k + 3];
  }
  return mesh;
}

class DoubleInstances : public test::EachDevice {
 protected:
  void SetUp() override {
    SCOPED_TRACE(kSeed);
    std::mt19937 random(kSeed);
    prototype_ = few_bits(ring(9, 7, {0, 0, 0}, 1, random));
    own_ = few_bits(ring(7, 5, {1, 2, 0}, 1.5, random));
    places_ = few_bits(random);
    all_ = own_;
    for (const Rows& place : places_) add(all_, moved(prototype_, place));
    options_.device.device = GetParam();
    options_.tree.geometry = VertexPrecision::float64;
    apart_.set_mask(apart_.add_mesh({own_.points(), own_.triangles}), kOwnMask);
    for (const Rows& place : places_) {
      const DoubleMesh copy = moved(prototype_, place);
      apart_.set_mask(apart_.add_mesh({copy.points(), copy.triangles}), kPlacedMask);
    }
    apart_.commit(options_);
    const GeometryId mesh =
        placed_.add_mesh({prototype_.points(), prototype_.triangles}, {.prototype = true});
    instances_ = placed_.add_instances(mesh, {&places_.front()[0], places_.size(), sizeof(Rows)},
                                       {.mask = kPlacedMask});
    placed_.set_mask(own_id_ = placed_.add_mesh({own_.points(), own_.triangles}), kOwnMask);
    placed_.commit(options_);
    rays_ = aimed(all_, 3000, 4, random);
  }

  // So many that a device looks at them first (`copies` of each), or few.
  RayList repeated(std::size_t copies) const {
    RayList many;
    for (std::size_t i = 0; i < copies * rays_.origins.size(); ++i) {
      many.origins.push_back(rays_.origins[i % rays_.origins.size()]);
      many.directions.push_back(rays_.directions[i % rays_.directions.size()]);
    }
    return many;
  }

  // `apart`: 0 for the scene's own mesh, from 1 for the copies.
  void is_same_place(std::uint32_t geometry, std::uint32_t instance, std::uint32_t apart) const {
    if (apart == kNoGeometry || apart == 0) {
      ASSERT_EQ(geometry, apart == 0 ? own_id_ : kNoGeometry);
      ASSERT_EQ(instance, kNoInstance);
    } else {
      ASSERT_EQ(geometry, instances_);
      ASSERT_EQ(instance, apart - 1);
    }
  }

  DoubleMesh prototype_, own_, all_;
  std::vector<Rows> places_;
  RayList rays_;
  CommitOptions options_;
  Scene placed_, apart_;
  GeometryId instances_ = 0, own_id_ = 0;
};

KDRAY_FOR_EACH_DEVICE(DoubleInstances);

struct Found {
  std::vector<double> t, u, v;
  std::vector<std::uint32_t> geometry, primitive, instance;
  std::vector<Point> normal;

  explicit Found(std::size_t n) : t(n), u(n), v(n), geometry(n), primitive(n), instance(n), normal(n) {}
  HitsOut out() {
    return {.t = t,
            .geometry = geometry,
            .primitive = primitive,
            .u = u,
            .v = v,
            .normal = {&normal.front()[0], normal.size(), sizeof(Point)},
            .instance = instance};
  }
};

TEST_P(DoubleInstances, AreHitAsMeshesOfTheirOwnAre) {
  for (const std::size_t copies : {1, 12}) {
    const RayList list = repeated(copies);
    const std::size_t n = list.origins.size();
    Found placed(n), apart(n);
    placed_.closest(list.rays(), placed.out());
    apart_.closest(list.rays(), apart.out());
    std::vector<std::size_t> of_place(kPlaces + 1);
    for (std::size_t i = 0; i < n; ++i) {
      SCOPED_TRACE(i);
      is_same_place(placed.geometry[i], placed.instance[i], apart.geometry[i]);
      ASSERT_EQ(placed.primitive[i], apart.primitive[i]);
      ASSERT_EQ(placed.t[i], apart.t[i]);
      ASSERT_NEAR(placed.u[i], apart.u[i], 1e-15);
      ASSERT_NEAR(placed.v[i], apart.v[i], 1e-15);
      if (apart.geometry[i] == kNoGeometry) continue;
      ++of_place[apart.geometry[i]];
      // What is in front of the prototype's triangle stays there when all is mirrored.
      const bool is_mirrored = apart.geometry[i] != 0 && apart.geometry[i] % 2 == 0;
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_NEAR(placed.normal[i][k], (is_mirrored ? -1 : 1) * apart.normal[i][k], 1e-15);
    }
    for (const std::size_t hits : of_place) EXPECT_GT(hits, 20u);
  }
}

TEST_P(DoubleInstances, AreCountedAndListedAsMeshesOfTheirOwnAre) {
  for (const std::size_t copies : {1, 12}) {
    const RayList list = repeated(copies);
    const std::size_t n = list.origins.size();
    std::vector<std::uint32_t> counts(n), counts_apart(n);
    std::vector<std::uint8_t> any(n), any_apart(n);
    placed_.count(list.rays(), counts), apart_.count(list.rays(), counts_apart);
    placed_.any(list.rays(), any), apart_.any(list.rays(), any_apart);
    ASSERT_EQ(counts, counts_apart);
    ASSERT_EQ(any, any_apart);
    const AllHits all = placed_.all(list.rays()), all_apart = apart_.all(list.rays());
    ASSERT_EQ(all.splits, all_apart.splits);
    ASSERT_EQ(all.t, all_apart.t);
    for (std::size_t i = 0; i < all.t.size(); ++i) {
      SCOPED_TRACE(i);
      is_same_place(all.geometry[i], all.instance[i], all_apart.geometry[i]);
      ASSERT_EQ(all.primitive[i], all_apart.primitive[i]);
      ASSERT_NEAR(all.u[i], all_apart.u[i], 1e-7);
    }
  }
}

TEST_P(DoubleInstances, HaveMasks) {
  const RayList list = repeated(12);
  const std::size_t n = list.origins.size();
  std::vector<std::uint32_t> masks(n), geometry(n), geometry_apart(n), instance(n);
  for (std::size_t i = 0; i < n; ++i) masks[i] = static_cast<std::uint32_t>(i * 7 % 4);
  Rays rays = list.rays();
  rays.masks = masks;
  placed_.closest(rays, {.geometry = geometry, .instance = instance});
  apart_.closest(rays, {.geometry = geometry_apart});
  for (std::size_t i = 0; i < n; ++i) {
    SCOPED_TRACE(i);
    is_same_place(geometry[i], instance[i], geometry_apart[i]);
    ASSERT_TRUE(geometry_apart[i] == kNoGeometry ||
                (masks[i] & (geometry_apart[i] == 0 ? kOwnMask : kPlacedMask)) != 0);
  }
}

TEST_P(DoubleInstances, AreHiddenByAMaskOfNothing) {
  placed_.set_mask(instances_, 0);
  placed_.commit(options_);
  for (const std::size_t copies : {1, 12}) {
    const RayList list = repeated(copies);
    const std::size_t n = list.origins.size();
    std::vector<std::uint32_t> geometry(n), counts(n);
    placed_.closest(list.rays(), {.geometry = geometry});
    placed_.count(list.rays(), counts);
    EXPECT_EQ(std::ranges::count(geometry, instances_), 0);
    EXPECT_GT(std::ranges::count(geometry, own_id_), 20);
    const AllHits all = placed_.all(list.rays());
    EXPECT_EQ(std::ranges::count(all.geometry, instances_), 0);
    for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(counts[i], all.splits[i + 1] - all.splits[i]) << i;
  }
}

// Floats refuse to measure distances to instances; these are measured.
TEST_P(DoubleInstances, AreWherePointsAreMeasuredTo) {
  const std::size_t n = rays_.origins.size();
  const Points points(&rays_.origins.front()[0], n, sizeof(Point));
  std::vector<double> distance(n), distance_apart(n), sign(n), sign_apart(n), u(n), u_apart(n);
  std::vector<std::uint32_t> geometry(n), geometry_apart(n), primitive(n), primitive_apart(n), instance(n);
  std::vector<std::uint8_t> inside(n), inside_apart(n);
  placed_.closest_points(
      points,
      {.distance = distance, .geometry = geometry, .primitive = primitive, .u = u, .instance = instance});
  apart_.closest_points(
      points,
      {.distance = distance_apart, .geometry = geometry_apart, .primitive = primitive_apart, .u = u_apart});
  placed_.signed_distance(points, sign), apart_.signed_distance(points, sign_apart);
  placed_.inside(points, inside), apart_.inside(points, inside_apart);
  EXPECT_EQ(inside, inside_apart);
  EXPECT_EQ(sign, sign_apart);
  EXPECT_EQ(distance, distance_apart);
  EXPECT_EQ(primitive, primitive_apart);
  for (std::size_t i = 0; i < n; ++i) {
    SCOPED_TRACE(i);
    is_same_place(geometry[i], instance[i], geometry_apart[i]);
    ASSERT_NEAR(u[i], u_apart[i], 1e-12);
  }
}

TEST_P(DoubleInstances, MoveWithTheirTransforms) {
  for (Rows& place : places_) place[3] += 1.0 / 1024;
  placed_.update_transforms(instances_, {&places_.front()[0], places_.size(), sizeof(Rows)});
  placed_.commit(options_);
  Scene anew;
  const GeometryId mesh = anew.add_mesh({prototype_.points(), prototype_.triangles}, {.prototype = true});
  anew.add_instances(mesh, {&places_.front()[0], places_.size(), sizeof(Rows)});
  anew.add_mesh({own_.points(), own_.triangles});
  anew.commit(options_);
  const std::size_t n = rays_.origins.size();
  std::vector<double> t(n), t_anew(n), t_before(n);
  placed_.closest(rays_.rays(), {.t = t});
  anew.closest(rays_.rays(), {.t = t_anew});
  apart_.closest(rays_.rays(), {.t = t_before});
  EXPECT_EQ(t, t_anew);
  EXPECT_NE(t, t_before);
}

}  // namespace
}  // namespace kdray
