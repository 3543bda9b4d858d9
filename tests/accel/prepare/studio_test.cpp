#include "accel/prepare/view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "scene/model/frame.h"

namespace kdray::prepare {
namespace {

// A box whose faces look outward, or inward; without the faces of `open` (2*axis + side).
void add_box(scene::Scene& s, const dvec3& lo, const dvec3& hi, bool inward, int open = -1) {
  const auto first = static_cast<std::uint32_t>(s.vertices.size());
  for (unsigned i = 0; i < 8; ++i)
    s.vertices.push_back({i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z});
  const auto add = [&](unsigned a, unsigned b, unsigned c) {
    if (inward) std::swap(b, c);
    s.triangles.push_back({.vertex = {first + a, first + b, first + c},
                           .number = static_cast<std::uint32_t>(s.triangles.size())});
  };
  for (unsigned axis = 0; axis < 3; ++axis)
    for (unsigned side = 0; side < 2; ++side) {
      if (open == static_cast<int>(2 * axis + side)) continue;
      const unsigned u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3, at = side << axis;
      const unsigned p = side ? u : v, q = side ? v : u;
      add(at, at + p, at + p + q), add(at, at + p + q, at + q);
    }
}

// A ball whose faces look outward, or inward.
void add_ball(scene::Scene& s, const dvec3& middle, double radius, bool inward) {
  const auto first = static_cast<std::uint32_t>(s.vertices.size());
  constexpr unsigned kRings = 24, kSides = 48;
  for (unsigned i = 0; i <= kRings; ++i)
    for (unsigned k = 0; k < kSides; ++k) {
      const double up = M_PI * i / kRings, around = 2 * M_PI * k / kSides;
      s.vertices.push_back(middle + radius * dvec3(std::sin(up) * std::cos(around), std::cos(up),
                                                   -std::sin(up) * std::sin(around)));
    }
  for (unsigned i = 0; i < kRings; ++i)
    for (unsigned k = 0; k < kSides; ++k) {
      const unsigned a = first + i * kSides + k, b = first + i * kSides + (k + 1) % kSides;
      for (std::array<unsigned, 3> t :
           {std::array{a, a + kSides, b + kSides}, std::array{a, b + kSides, b}}) {
        if (inward) std::swap(t[1], t[2]);
        s.triangles.push_back(
            {.vertex = {t[0], t[1], t[2]}, .number = static_cast<std::uint32_t>(s.triangles.size())});
      }
    }
}

scene::Studio studio_of(scene::Scene s, const std::string& name = "a.ply") {
  s.name = name;
  s.materials.emplace_back();
  scene::frame_scene(s);
  const Prepared made = in_studio(prepare(s, {}));
  EXPECT_TRUE(made.settings.framing.studio);
  return made.settings.framing.studio.value_or(scene::Studio());
}

// A ball on a plinth along an axis.
scene::Scene statue(int axis) {
  scene::Scene s;
  dvec3 lo(-1), hi(1), ball(0);
  lo[axis] = 0, hi[axis] = 0.4, ball[axis] = 3;
  add_box(s, lo, hi, false);
  add_ball(s, ball, 0.7, false);
  return s;
}

TEST(InStudio, WhatStandsOnABaseAcrossZHasZUp) {
  EXPECT_EQ(studio_of(statue(2)).up, dvec3(0, 0, 1));
  EXPECT_EQ(studio_of(statue(1)).up, dvec3(0, 1, 0));
  EXPECT_EQ(studio_of(statue(0)).up, dvec3(0, 1, 0)) << "x is never up";
  EXPECT_EQ(studio_of(statue(2), "a.glb").up, dvec3(0, 1, 0)) << "glTF says that y is up";
  scene::Scene ball;
  add_ball(ball, dvec3(5, 6, 7), 2, false);
  EXPECT_EQ(studio_of(ball).up, dvec3(0, 1, 0));
  EXPECT_FALSE(studio_of(ball).perhaps_on_side);
}

// A double pyramid, which is flat nowhere, on a base of a sixteenth of what lies under it.
TEST(InStudio, ASmallBaseAcrossZIsAHint) {
  for (const int axis : {1, 2}) {
    scene::Scene s;
    dvec3 middle(0), lo(-0.5), hi(0.5);
    middle[axis] = 3, lo[axis] = 0.5, hi[axis] = 1.5;
    for (int k = 0; k < 6; ++k) {
      s.vertices.push_back(middle);
      s.vertices.back()[k / 2] += k % 2 ? 2 : -2;
    }
    for (const unsigned x : {0u, 1u})
      for (const unsigned y : {2u, 3u})
        for (const unsigned z : {4u, 5u})
          s.triangles.push_back(
              {.vertex = {x, y, z}, .number = static_cast<std::uint32_t>(s.triangles.size())});
    add_box(s, lo, hi, false);
    const scene::Studio studio = studio_of(s);
    EXPECT_EQ(studio.up, dvec3(0, 1, 0));
    EXPECT_EQ(studio.perhaps_on_side, axis == 2);
  }
}

TEST(InStudio, ARoomIsSeenFromWithin) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE("seed 5, room " + std::to_string(i));
    const dvec3 lo = dvec3(unit(random), unit(random), unit(random)) * 100.0 - 50.0;
    const dvec3 size(4 + 8 * unit(random), 2.5 + unit(random), 4 + 8 * unit(random));
    scene::Scene s;
    add_box(s, lo, lo + size, true);
    for (int n = 0; n < 5; ++n) {  // furniture
      const dvec3 at = lo + dvec3(0.1 + 0.7 * unit(random), 0, 0.1 + 0.7 * unit(random)) * size;
      add_box(s, at, at + dvec3(0.6, 0.8, 0.6), false);
    }
    const scene::Studio studio = studio_of(s, "room.obj");
    EXPECT_FALSE(studio.open_to);
    ASSERT_TRUE(studio.room);
    EXPECT_TRUE(scene::contains({lo, lo + size}, studio.room->from));
    EXPECT_TRUE(scene::contains({lo, lo + size}, studio.room->at));
    EXPECT_GT(glm::distance(studio.room->from, studio.room->at), 0.1 * glm::length(size));
    EXPECT_EQ(studio.up, dvec3(0, 1, 0));
  }
}

TEST(InStudio, ALowRoomHasItsUpAcross) {
  scene::Scene s;
  add_box(s, dvec3(0), dvec3(8, 6, 2.5), true);
  const scene::Studio studio = studio_of(s, "room.obj");
  EXPECT_EQ(studio.up, dvec3(0, 0, 1));
  ASSERT_TRUE(studio.room);
  EXPECT_NEAR(studio.room->from.z, 0.45 * 2.5, 1e-3);
}

TEST(InStudio, ARoomThatIsOpenOnOneSideIsSeenThroughIt) {
  for (const auto& [open, out] : {std::pair(5, dvec3(0, 0, 1)), std::pair(4, dvec3(0, 0, -1)),
                                  std::pair(0, dvec3(-1, 0, 0)), std::pair(1, dvec3(1, 0, 0))}) {
    scene::Scene s;
    add_box(s, dvec3(0), dvec3(2), true, open);
    add_box(s, dvec3(0.3, 0, 0.5), dvec3(0.8, 1.2, 1), false);
    const scene::Studio studio = studio_of(s);
    EXPECT_FALSE(studio.room);
    EXPECT_EQ(studio.open_to.value_or(dvec3(0)), out);
  }
}

TEST(InStudio, WhatIsSolidOrRoundIsNoRoom) {
  scene::Scene solid, ball, hollow;
  add_box(solid, dvec3(0), dvec3(3, 2, 1), false);
  add_ball(ball, dvec3(0), 1, false);
  add_ball(hollow, dvec3(0), 1, true);
  for (const scene::Scene* s : {&solid, &ball, &hollow}) {
    EXPECT_FALSE(studio_of(*s).room);
    EXPECT_FALSE(studio_of(*s).open_to);
    EXPECT_TRUE(studio_of(*s).stands);
  }
}

TEST(InStudio, AGroundAroundAllIsFloorEnough) {
  scene::Scene s;
  add_ball(s, dvec3(0, 1, 0), 1, false);
  EXPECT_TRUE(studio_of(s).stands);
  add_box(s, dvec3(-500, -1, -500), dvec3(500, 0, 500), false);
  EXPECT_FALSE(studio_of(s).stands);
}

TEST(InStudio, SamplesAreEightUnlessTheFileSaysHowMany) {
  scene::Scene s = statue(1);
  s.materials.emplace_back();
  scene::frame_scene(s);
  EXPECT_FALSE(prepare(s, {}).settings.settings.samples);
  EXPECT_EQ(in_studio(prepare(s, {})).settings.settings.samples, 8);
  s.settings.samples = 3;
  EXPECT_EQ(in_studio(prepare(s, {})).settings.settings.samples, 3);
}

TEST(InStudio, AFileWithACameraOrLightsKeepsThem) {
  scene::Scene s = statue(1);
  s.materials.emplace_back();
  scene::Scene lit = s, seen = s, unlit = s;
  lit.lights = {{.position = {1, 2, 3}}};
  seen.camera = scene::Camera{};
  unlit.unlit = true;
  for (scene::Scene* own : {&lit, &seen, &unlit}) {
    scene::frame_scene(*own);
    EXPECT_FALSE(in_studio(prepare(*own, {})).settings.framing.studio);
  }
}

}  // namespace
}  // namespace kdray::prepare
