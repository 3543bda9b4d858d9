// What    Scenes of all sizes from 1e-30 to 1e30: the same scene 2^k times as large has the same hits and the
//         same picture, bit for bit; 10^k times as large, it has the hits that an independent tracer in
//         double finds.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "conformance/samples.h"
#include "kdray/kdray.h"
#include "oracle/primitives.h"
#include "pictures/scenes.h"
#include "stress/random.h"
#include "stress/traced.h"

namespace kdray::stress {
namespace {

constexpr std::uint64_t kSeed = 7000;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

class Scales : public testing::Test {
 protected:
  void SetUp() override {
    if (devices().empty()) GTEST_SKIP() << "no OpenCL device";
  }
};

std::vector<int> exponents() {
  return is_full() ? std::vector<int>{-100, -73, -47, -20, -5, -1, 1, 3, 24, 46, 77, 100}
                   : std::vector<int>{-100, -1, 46, 100};
}

// All kinds of primitives, lights and rays.
scene::Scene model() {
  scene::Scene s = test::every_light();
  test::Draw draw(kSeed);
  primitives::for_each_kind([&](auto kind) {
    for (std::uint32_t material = 0; material < 2; ++material)
      test::Samples<decltype(kind)>::add(s, material, draw);
  });
  return s;
}

Picture picture_of(const scene::Scene& scene) {
  Renderer renderer{Scene(scene::Scene(scene))};
  RenderOptions options;
  options.width = 96, options.height = 72, options.channels = {"depth", "primitive"};
  return renderer.render(options);
}

// `scale` is a power of two, which rounds none of them.
std::vector<Ray> rays_at(double scale, std::size_t n) {
  return make_rays(0, n, [scale](std::uint64_t i) {
    Random random(kSeed, i);
    const vec3 o(6.0 * random.uniform() * random.direction());
    const vec3 d(random.log_uniform(1e-3, 1e3) * random.direction());
    const auto s = static_cast<float>(scale);
    return Ray{{o.x * s, o.y * s, o.z * s}, 0, {d.x, d.y, d.z}, kInfinity};
  });
}

TEST_F(Scales, PowersOfTwoHaveTheSamePicture) {
  const Picture wanted = picture_of(model());
  for (const int k : exponents()) {
    SCOPED_TRACE(testing::Message() << "2^" << k);
    const Picture picture = picture_of(test::moved(model(), std::ldexp(1.0, k), dvec3(0)));
    EXPECT_EQ(picture.rgb, wanted.rgb);
    ASSERT_EQ(picture.channels.size(), wanted.channels.size());
    for (std::size_t i = 0; i < wanted.channels[0].values.size(); ++i)
      ASSERT_EQ(picture.channels[0].values[i], std::ldexp(wanted.channels[0].values[i], k)) << "depth";
    EXPECT_EQ(picture.channels[1].values, wanted.channels[1].values);
  }
}

// Far beyond float's range too: coordinates are read as double.
TEST_F(Scales, WhatOnlyDoublesHoldHasTheSamePicture) {
  const Picture wanted = picture_of(model());
  for (const int k : {-480, 480})
    EXPECT_EQ(picture_of(test::moved(model(), std::ldexp(1.0, k), dvec3(0))).rgb, wanted.rgb) << "2^" << k;
}

TEST_F(Scales, PowersOfTwoHaveTheSameHits) {
  const std::size_t n = is_full() ? 200000 : 5000;
  Renderer one{Scene(model())};
  const std::vector<Ray> rays = rays_at(1, n);
  for (const int k : exponents()) {
    SCOPED_TRACE(testing::Message() << "2^" << k << ", seed " << kSeed);
    const double scale = std::ldexp(1.0, k);
    Renderer other{Scene(test::moved(model(), scale, dvec3(0)))};
    for (const Walk& walk : kWalks) {
      const std::vector<Hit> wanted = one.trace(rays, false, 1, walk.traversal),
                             hits = other.trace(rays_at(scale, n), false, 1, walk.traversal);
      std::size_t found = 0;
      for (std::size_t i = 0; i < n; ++i) {
        Hit hit = wanted[i];
        hit.t = std::ldexp(hit.t, k);
        found += hit.primitive >= 0;
        ASSERT_TRUE(same_bits(hits[i], hit)) << walk.name << ", ray " << i;
      }
      EXPECT_GT(found, n / 4);
    }
  }
}

// Directions of any length: t counts in multiples of them, and is infinite where no float holds it.
TEST_F(Scales, DirectionsOfAnyLengthHitTheSame) {
  constexpr std::size_t kRays = 1000;
  Renderer renderer{Scene(model())};
  const std::vector<Ray> rays = rays_at(1, kRays);
  for (const Walk& walk : kWalks) {
    const std::vector<Hit> wanted = renderer.trace(rays, false, 1, walk.traversal);
    for (const int k : {-110, -60, 60, 110}) {
      std::vector<Ray> scaled(rays);
      for (Ray& ray : scaled)
        for (float& d : ray.direction) d = std::ldexp(d, k);
      const std::vector<Hit> hits = renderer.trace(scaled, false, 1, walk.traversal);
      for (std::size_t i = 0; i < kRays; ++i) {
        ASSERT_EQ(hits[i].primitive, wanted[i].primitive) << walk.name << " 2^" << k << ", ray " << i;
        ASSERT_EQ(hits[i].t, std::ldexp(wanted[i].t, -k)) << walk.name << " 2^" << k << ", ray " << i;
      }
    }
    // So short that t is beyond float's range: hits all the same. A coordinate of a denormal has few bits:
    // along an axis that is no matter.
    const Ray tiny{{0.1f, 9, 0.05f}, 0, {0, -1e-42f, 0}, kInfinity};
    const Ray plain{{0.1f, 9, 0.05f}, 0, {0, -1, 0}, kInfinity};
    const Hit far = renderer.trace(std::vector<Ray>{tiny}, false, 1, walk.traversal)[0];
    EXPECT_EQ(far.primitive, renderer.trace(std::vector<Ray>{plain}, false, 1, walk.traversal)[0].primitive);
    EXPECT_GE(far.primitive, 0);
    EXPECT_EQ(far.t, kInfinity);
  }
}

// From beyond 2^60 times the scene's size, where no float about the scene holds the origin.
TEST_F(Scales, RaysFromFarOutsideArrive) {
  for (const double scale : {1e-30, 1.0, 1e10}) {
    SCOPED_TRACE(scale);
    scene::Scene ball;
    ball.materials.resize(1);
    ball.spheres = {{.center = dvec3(0), .radius = scale}};
    Renderer renderer{Scene(std::move(ball))};
    const auto far = static_cast<float>(1e27 * scale), off = static_cast<float>(2 * scale);
    const std::vector<Ray> rays{{{far, 0, 0}, 0, {-1, 0, 0}, kInfinity},
                                {{far, 0, 0}, 0, {1, 0, 0}, kInfinity},
                                {{far, off, 0}, 0, {-1, 0, 0}, kInfinity},
                                {{0, 0, -far}, 0, {0, 0, 1}, 0.5f * far},
                                {{far, far, far}, 0, {0, 0, 1}, kInfinity}};
    for (const Walk& walk : kWalks) {
      const std::vector<Hit> hits = renderer.trace(rays, false, 1, walk.traversal);
      EXPECT_EQ(hits[0].primitive, 0) << walk.name;
      EXPECT_EQ(hits[0].t, far) << walk.name;
      for (std::size_t i = 1; i < rays.size(); ++i)
        EXPECT_EQ(hits[i].primitive, -1) << walk.name << ", ray " << i;
    }
  }
}

TEST_F(Scales, PowersOfTenHaveTheOraclesHits) {
  const std::size_t n = is_full() ? 20000 : 1000;
  for (const int k : {-30, -14, -7, 5, 14, 30})
    for (const double away : {0.0, 1e3}) {
      SCOPED_TRACE(testing::Message() << "10^" << k << ", " << away << " sizes off, seed " << kSeed);
      const double scale = std::pow(10, k);
      const dvec3 offset = scale * away * dvec3(1, -0.7, 0.3);
      const scene::Scene moved = test::moved(model(), scale, offset);
      // Its picture in double, where squares of 1e-30 and 1e30 are no matter.
      const oracle::World world(moved);
      Renderer renderer{Scene(scene::Scene(moved))};
      const std::vector<Ray> rays = make_rays(0, n, [&](std::uint64_t i) {
        Random random(kSeed + 1, i);
        const vec3 o(offset + 6.0 * scale * random.uniform() * random.direction()), d(random.direction());
        return Ray{{o.x, o.y, o.z}, 0, {d.x, d.y, d.z}, kInfinity};
      });
      for (const Walk& walk : kWalks) {
        const std::vector<Hit> hits = renderer.trace(rays, false, 1, walk.traversal);
        std::size_t differing = 0, found = 0;
        for (std::size_t i = 0; i < n; ++i) {
          const auto& r = rays[i];
          const oracle::Hit wanted = world.closest(
              {{r.origin[0], r.origin[1], r.origin[2]}, {r.direction[0], r.direction[1], r.direction[2]}});
          found += wanted.found();
          // Where it grazes, or meets an edge, rounding decides.
          const bool same = hits[i].primitive == wanted.primitive &&
                            (!wanted.found() || std::abs(hits[i].t - wanted.t) < 1e-3 * scale);
          differing += !same;
        }
        EXPECT_LE(differing, n / 200) << walk.name;
        EXPECT_GT(found, n / 4);
      }
    }
}

}  // namespace
}  // namespace kdray::stress
