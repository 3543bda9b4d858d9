// The checks as a whole: sound scenes of all kinds pass, on every device; and a check that is given wrong
// geometry does cry out.
#include "apps/verify/probes.h"

#include <gtest/gtest.h>

#include "apps/verify/meshes.h"
#include "apps/verify/tracer.h"
#include "apps/verify/verify.h"
#include "support/device.h"
#include "support/zero_area_meshes.h"

namespace kdray::verify {
namespace {

class Verify : public test::EachDevice {
 protected:
  Findings check(Builder& b, std::uint64_t rays = 20000) {
    return verify(b.scene(), {.rays = rays, .device = {.device = GetParam()}});
  }
};

void expect_sound(const Findings& f) {
  EXPECT_TRUE(f.kdray_is_sound()) << f.film.fault;
  for (std::size_t i = 0; i < kDefects; ++i) EXPECT_EQ(f.probes.count[i], 0u) << "defect " << i;
}

TEST_P(Verify, ClosedMeshesDoNotLeak) {
  Builder cube, ball, slivers, far;
  cube.cube({-1, -1, -1}, 2);
  ball.ball({0, 0, 0}, 1, 40);
  slivers.ball({0, 0, 0}, 1, 6);
  for (dvec3& v : slivers.scene().vertices) v.z *= 1e-3;
  far.ball({0, 0, 0}, 1, 20).moved({1e6, 1e6, -1e6});
  for (Builder* b : {&cube, &ball, &slivers, &far}) {
    const Findings f = check(*b);
    expect_sound(f);
    EXPECT_TRUE(f.mesh_is_sound());
    EXPECT_GE(f.probes.from_inside, 10000u);
    EXPECT_EQ(f.probes.components, 1u);
    EXPECT_LT(f.probes.in_doubt, f.probes.from_inside / 10);
    EXPECT_GT(f.probes.leaving, 20000u);
  }
}

// T-junctions that are closed by triangles without area: those are hit, left and shaded like others.
TEST_P(Verify, ZeroAreaClosesAndIsLeft) {
  for (const test::LatticeMesh& m : test::zero_area_meshes()) {
    SCOPED_TRACE(m.name);
    Builder b;
    b.scene() = test::scene_of(m);
    const Findings f = check(b, 40000);
    expect_sound(f);
    EXPECT_EQ(f.topology.count([](const Component& c) { return c.watertight; }), 1u);
    EXPECT_EQ(f.counts.zero_area, m.n_without_area());
    EXPECT_GT(f.probes.from_inside, 10000u);
  }
}

// One in another, one through another: an inner hit is no leak of the outer.
TEST_P(Verify, ComponentsInEachOtherAreNoLeaks) {
  Builder b;
  b.ball({0, 0, 0}, 2, 24).ball({0.3, 0, 0}, 1, 16).cube({0.5, -0.5, -0.5}, 3);
  const Findings f = check(b, 40000);
  expect_sound(f);
  EXPECT_EQ(f.probes.components, 3u);
}

TEST_P(Verify, SpheresAndConesToo) {
  Builder b;
  b.sphere({0, 0, 0}, 1).sphere({0, 0, 0}, 0.5).sphere({1.5, 0, 0}, 0.5).sphere({100, 0, 0}, 0.001);
  b.cone({0, 3, 0}, 1, {0, 5, 0}, 0)
      .cone({3, 3, 0}, 0.1, {3, 6, 1}, 0.1)
      .cone({0, -3, 0}, 1, {0, -3.01, 0}, 0.2);
  const Findings f = check(b);
  expect_sound(f);
  EXPECT_EQ(f.probes.from_inside, 0u);
  EXPECT_GT(f.probes.leaving, 10000u);
}

TEST_P(Verify, MessesAreFindingsAboutTheMeshOnly) {
  Builder b;
  b.moebius(16).cube({2, 0, 0}, 1).cube({2.5, 0, 0}, 1).cube({2, 0, 0}, 1);
  b.face({0, 0, 0}, {0, 0, 0}, {1, 0, 0}).face({5, 0, 0}, {9, 1, 1}, {5, 1e-6, 0});
  const Findings f = check(b);
  expect_sound(f);
  EXPECT_FALSE(f.mesh_is_sound());
  EXPECT_EQ(f.dropped, 1u);
  EXPECT_EQ(f.duplicates.doubled.size(), 12u);
  EXPECT_GT(f.duplicates.overlapping.size(), 0u);
}

TEST_P(Verify, OneTriangleAndNothing) {
  Builder one, none;
  one.face({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const Findings f = check(one);
  expect_sound(f);
  EXPECT_EQ(f.topology.open.size(), 3u);
  const Findings empty = check(none);
  EXPECT_TRUE(empty.kdray_is_sound());
  EXPECT_EQ(empty.probes.rays(), 0u);
}

TEST_P(Verify, TheSameTwice) {
  Builder b;
  b.ball({0, 0, 0}, 1, 12).sphere({2, 0, 0}, 0.5);
  const Findings f = check(b), g = check(b);
  EXPECT_EQ(f.probes.from_inside, g.probes.from_inside);
  EXPECT_EQ(f.probes.leaving, g.probes.leaving);
  EXPECT_EQ(f.probes.in_doubt, g.probes.in_doubt);
}

// The checks can fail: the tracer is given a scene with holes, the checks are told that it is whole.
TEST_P(Verify, AHoleInTheTracedSceneIsALeakAndALostHit) {
  Builder whole, holed;
  whole.ball({0, 0, 0}, 1, 12);
  holed.ball({0, 0, 0}, 1, 12);
  // The face shrinks to a speck, so that the numbers stay.
  const scene::Triangle& gone = holed.scene().triangles[100];
  for (const std::uint32_t v : gone.vertex)
    holed.scene().vertices[v] = dvec3(0) + 1e-6 * dvec3(v % 3 == 0, v % 3 == 1, 0);
  const Meshed m(whole);
  const prepare::Prepared traced = in_local_space(prepare::prepare(holed.scene(), TreeOptions{}));
  Tracer tracer(traced, {.device = GetParam()});
  const Probes p = probe({whole.scene(), m.geometry, m.mesh, m.boxes, m.topology}, tracer, 20000);
  EXPECT_GT(p.count[static_cast<std::size_t>(Defect::leak)], 10u);
  EXPECT_GT(p.count[static_cast<std::size_t>(Defect::lost_hit)], 10u);
  EXPECT_FALSE(p.witnesses.empty());
}

// A leak that ends on another component's wall is one all the same.
TEST_P(Verify, AHoleIsALeakThoughSomethingLiesBehindIt) {
  Builder whole, holed;
  for (Builder* b : {&whole, &holed}) b->ball({0, 0, 0}, 1, 12).cube({-3, -3, -3}, 6);
  for (const std::uint32_t v : holed.scene().triangles[100].vertex)
    holed.scene().vertices[v] = dvec3(2.9) + 1e-6 * dvec3(v % 3 == 0, v % 3 == 1, 0);
  const Meshed m(whole);
  const prepare::Prepared traced = in_local_space(prepare::prepare(holed.scene(), TreeOptions{}));
  Tracer tracer(traced, {.device = GetParam()});
  const Probes p = probe({whole.scene(), m.geometry, m.mesh, m.boxes, m.topology}, tracer, 20000);
  EXPECT_GT(p.count[static_cast<std::size_t>(Defect::leak)], 10u);
}

TEST_P(Verify, APictureOfWhereShowsTheFindingsAndTheirNumbers) {
  Builder b;
  b.cube({-1, -1, -1}, 2);
  turn_over(b.scene().triangles[3]);
  b.scene().camera = scene::Camera{{3, 2, 5}, {0, 0, 0}, {0, 1, 0}, 0.7, 0};
  const Findings f =
      verify(b.scene(), {.rays = 1000, .width = 400, .height = 240, .device = {.device = GetParam()}});
  ASSERT_EQ(f.picture.pixels.size(), 400u * 240);
  int colored = 0, grey = 0;
  for (const vec3& p : f.picture.pixels) {
    colored += p.x > p.z + 0.2f;  // the flipped face's orange
    grey += p.x == p.z && p.x > 0.25f && p.x < 0.75f;
  }
  EXPECT_GT(colored, 200);
  EXPECT_GT(grey, 2000);
}

KDRAY_FOR_EACH_DEVICE(Verify);

}  // namespace
}  // namespace kdray::verify
