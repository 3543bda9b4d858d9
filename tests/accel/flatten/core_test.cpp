// What    The core and the faces of small scenes, worked out by hand.
#include "accel/flatten/core.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kdray::flatten {
namespace {

FlatScene flat_of(const std::vector<layout::Triangle>& triangles,
                  const std::vector<layout::Sphere>& spheres) {
  FlatScene flat;
  flat.triangles = Array<layout::Triangle>::copy_of(triangles);
  flat.spheres = Array<layout::Sphere>::copy_of(spheres);
  return flat;
}

layout::Triangle triangle(vec3 a, vec3 b, vec3 c) {
  layout::Triangle t{};
  const vec3 v[3] = {a, b, c};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) t.v[i][k] = v[i][k];
  return t;
}

layout::Sphere sphere(vec3 center, float radius) {
  layout::Sphere s{};
  for (int k = 0; k < 3; ++k) s.center[k] = center[k];
  s.radius = radius;
  return s;
}

// Twelve wide, at height z.
layout::Triangle floor_at(float z) {
  return triangle({-6, -6, z}, {6, -6, z}, {0, 6, z});
}

Array<layout::Light> lights_at(const std::vector<vec3>& places) {
  std::vector<layout::Light> lights(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    lights[i].kind = KDRAY_LIGHT_POINT;
    for (int k = 0; k < 3; ++k) lights[i].position[k] = places[i][k];
  }
  return Array<layout::Light>::copy_of(lights);
}

std::uint32_t open_lights(const Core& core, const Array<layout::Light>& lights) {
  layout::Frame frame{};
  frame.world_max = 6;
  core.apply(frame, lights);
  return frame.open_lights;
}

TEST(Core, IsWhatStandsOnTheFloor) {
  const Core core = core_of(flat_of({floor_at(0)}, {sphere({1, 0, 2}, 1)}));
  EXPECT_TRUE(core.has_faces);
  for (int k = 0; k < 3; ++k) {
    const float center[] = {1, 0, 2};
    EXPECT_LE(core.lo[k], center[k] - 1);
    EXPECT_GE(core.hi[k], center[k] + 1);
    EXPECT_NEAR(core.lo[k], center[k] - 1, 1e-4);
    EXPECT_NEAR(core.hi[k], center[k] + 1, 1e-4);
  }
  EXPECT_EQ(core.face_lo.z, 0);
  EXPECT_EQ(core.face_lo.x, -INFINITY);
  EXPECT_EQ(core.face_hi, vec3(INFINITY));
}

TEST(Core, ACeilingIsAFaceAbove) {
  const Core core = core_of(flat_of({floor_at(9)}, {sphere({1, 0, 2}, 1)}));
  EXPECT_TRUE(core.has_faces);
  EXPECT_EQ(core.face_hi.z, 9);
  EXPECT_EQ(core.face_lo, vec3(-INFINITY));
  EXPECT_EQ(open_lights(core, lights_at({{0, 0, 5}, {0, 0, 10}})), 0b1u);
}

// A triangle in the floor's plane is in a face, whether or not the rest touches the plane too.
TEST(Core, FaceCountsWhereTheCoreTouchesIt) {
  const Core core = core_of(flat_of({floor_at(0), triangle({0, 0, 0}, {1, 0, 0}, {0, 0, 1})}, {}));
  EXPECT_TRUE(core.has_faces);
  EXPECT_EQ(core.lo, vec3(0));
  EXPECT_EQ(core.hi, vec3(1, 0, 1));
  EXPECT_EQ(core.face_lo.z, 0);
}

// One that lies in the floor's plane may be hit from above all the same.
TEST(Core, AZeroAreaTriangleIsNoPartOfAFace) {
  layout::Triangle zero_area = triangle({-6, 0, 0}, {0, 0, 0}, {6, 0, 0});
  zero_area.normals = KDRAY_ZERO_AREA;
  const Core core = core_of(flat_of({floor_at(0), zero_area}, {}));
  EXPECT_TRUE(core.has_faces);
  EXPECT_EQ(core.lo, vec3(-6, 0, 0));
  EXPECT_EQ(core.hi, vec3(6, 0, 0));
}

TEST(Core, IsEverythingWithoutFaces) {
  // The floor is tilted; it lies within the core; it is all there is.
  const layout::Triangle tilted = triangle({-6, -6, 0}, {6, -6, 0}, {0, 6, 0.001f});
  EXPECT_FALSE(core_of(flat_of({tilted}, {sphere({1, 0, 2}, 1)})).has_faces);
  EXPECT_FALSE(
      core_of(flat_of({triangle({0, 0, 2}, {1, 0, 2}, {1, 0.5f, 2})}, {sphere({1, 0, 2}, 1)})).has_faces);
  EXPECT_FALSE(core_of(flat_of({floor_at(0)}, {})).has_faces);
  EXPECT_FALSE(core_of(flat_of({}, {})).has_faces);
  EXPECT_FALSE(core_of(flat_of({}, {})).is_known);
  const Core ball = core_of(flat_of({}, {sphere({1, 0, 2}, 1)}));
  EXPECT_TRUE(ball.is_known);
  EXPECT_EQ(open_lights(ball, lights_at({{0, 0, 5}, {0, 0, -5}})), 0b11u);
}

TEST(Core, KnowsWhichLightsAreInside) {
  const Core core = core_of(flat_of({floor_at(0)}, {sphere({1, 0, 2}, 1)}));
  EXPECT_EQ(open_lights(core, lights_at({{0, 0, 5}, {0, 0, -5}, {0, 0, 0}, {0, 0, 1e-4f}, {99, 99, 1}})),
            0b10001u);
  // There are more than 32 lights, and those beyond are traced.
  EXPECT_EQ(open_lights(core, lights_at(std::vector<vec3>(40, {0, 0, 5}))), 0xffffffffu);
  Array<layout::Light> sun = lights_at({{0, 0, 5}});
  sun[0].kind = KDRAY_LIGHT_DIRECTIONAL;
  EXPECT_EQ(open_lights(core, sun), 0u);
}

}  // namespace
}  // namespace kdray::flatten
