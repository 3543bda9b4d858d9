#include "scene/model/studio.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kdray::scene {
namespace {

Scene in_studio(const DBox& box) {
  Scene s;
  s.camera = Camera{};
  s.framing = {.camera = true, .lights = true, .box = box, .studio = Studio{.stands = true}, .floor = {}};
  return s;
}

// Where a point falls in the picture: -1 to 1 across and up; needs to lie in front of the eye.
glm::dvec2 place_of(const Camera& c, double aspect, const dvec3& p) {
  const Basis view = basis_of(c);
  const double depth = glm::dot(p - c.from, view.forward), t = std::tan(c.vertical_fov / 2) * depth;
  EXPECT_GT(depth, 0);
  return {glm::dot(p - c.from, view.right) / (t * aspect), glm::dot(p - c.from, view.up) / t};
}

dvec3 any(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  return {unit(random), unit(random), unit(random)};
}

DBox any_box(std::mt19937& random) {
  const dvec3 middle = any(random) * std::pow(10, 6 * any(random).x);
  const dvec3 half = (glm::abs(any(random)) + 1e-3) * std::pow(10, 4 * any(random).x);
  return {middle - half, middle + half};
}

TEST(Studio, TheBoxTouchesTwoBordersAndIsInThePicture) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const DBox box = any_box(random);
    Scene s = in_studio(box);
    const double aspect = std::pow(4, any(random).x);
    if (seed % 3 == 1) s.framing.studio->up = {0, 0, 1};
    const View view = seed % 3 == 2 ? View{.up = any(random)} : View{};
    const Camera camera = camera_of(s, view, aspect);
    glm::dvec2 least(1e9), most(-1e9);
    for (const dvec3& corner : corners_of(box)) {
      const glm::dvec2 at = place_of(camera, aspect, corner);
      least = glm::min(least, at), most = glm::max(most, at);
    }
    const double border = 1 / 1.06;
    for (int k = 0; k < 2; ++k) EXPECT_TRUE(least[k] > -border - 1e-6 && most[k] < border + 1e-6) << k;
    const bool wide = std::abs(least.x + border) < 1e-6 && std::abs(most.x - border) < 1e-6;
    const bool high = std::abs(least.y + border) < 1e-6 && std::abs(most.y - border) < 1e-6;
    EXPECT_TRUE(wide || high) << least.x << " " << most.x << ", " << least.y << " " << most.y;
  }
}

TEST(Studio, LightsAndEyeAreAboveTheFloorAndAllStandsOnIt) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const DBox box = any_box(random);
    Scene s = in_studio(box);
    set_view(s, seed % 2 ? View{.up = any(random)} : View{}, 1);
    const Floor& floor = s.framing.floor;
    const double size = glm::length(box.extent());
    ASSERT_GT(floor.radius, floor.inner);
    const auto height = [&](const dvec3& p) { return glm::dot(p - floor.middle, floor.up); };
    double lowest = size;
    for (const dvec3& corner : corners_of(box)) {
      lowest = std::min(lowest, height(corner));
      EXPECT_LT(glm::distance(corner, floor.middle), floor.radius);
    }
    EXPECT_NEAR(lowest, 0, 1e-9 * size + 1e-14 * glm::length(box.center()));
    EXPECT_GT(height(s.camera->from), 0);
    ASSERT_EQ(s.lights.size(), 3u);
    for (const Light& light : s.lights) {
      EXPECT_EQ(light.kind, LightKind::sphere);
      EXPECT_GT(height(light.position), light.radius);
    }
    EXPECT_EQ(s.sky.up, floor.up);
    EXPECT_EQ(fault_of(s.sky), nullptr);
  }
}

TEST(Studio, LightsFollowTheCamera) {
  const DBox box{dvec3(-1), dvec3(1)};
  for (const dvec3 from :
       {dvec3(9, 1, 0), dvec3(-9, 1, 0), dvec3(0, 4, 9), dvec3(1, 1, -9), dvec3(0, 9, 0)}) {
    Scene s = in_studio(box);
    set_view(s,
             {.from = from, .up = from.x == 0 && from.z == 0 ? std::optional(dvec3(0, 0, 1)) : std::nullopt},
             1);
    const Basis view = basis_of(*s.camera);
    EXPECT_EQ(s.camera->from, from);
    EXPECT_LT(glm::dot(s.lights[0].position, view.right), 0) << "the key light comes from the left";
    EXPECT_GT(glm::dot(s.lights[1].position, view.right), 0);
    if (std::abs(view.forward.y) < 0.9) {
      EXPECT_GT(glm::dot(s.lights[2].position, view.forward), 0) << "the rim";
    }
  }
}

TEST(Studio, FromBelowTheLightsAreBelowAndThereIsNoFloor) {
  Scene s = in_studio({dvec3(-1), dvec3(1)});
  set_view(s, {.from = dvec3(2, -6, 3)}, 1);
  EXPECT_EQ(s.framing.floor.radius, 0);
  ASSERT_EQ(s.lights.size(), 3u);
  for (const Light& light : s.lights) EXPECT_LT(light.position.y, -1);
}

TEST(Studio, WhatTheViewAsksForWins) {
  Scene s = in_studio({dvec3(-1), dvec3(1)});
  const View view{.at = dvec3(0.3, 0.2, 0.1),
                  .up = dvec3(0, 0, 1),
                  .vertical_fov = 0.9,
                  .headlight = 0.5,
                  .background = vec3(0.2f, 0.5f, 0.7f)};
  set_view(s, view, 2);
  EXPECT_NEAR(glm::distance(s.camera->at, *view.at), 0, 1e-12);
  EXPECT_EQ(s.camera->up, *view.up);
  EXPECT_EQ(s.camera->vertical_fov, 0.9);
  for (const dvec3& corner : corners_of(s.framing.box)) {
    const glm::dvec2 at = place_of(*s.camera, 2, corner);
    EXPECT_LT(std::max(std::abs(at.x), std::abs(at.y)), 1);
  }
  EXPECT_EQ(s.lights.size(), 4u) << "the headlight is one more";
  EXPECT_EQ(s.sky.kind, SkyKind::none);
  EXPECT_EQ(s.background, *view.background);
  // The floor has the background's colour where all lights reach it.
  vec3 lit = s.framing.floor.unshadowed;
  for (std::size_t i = 0; i < 3; ++i) {
    const dvec3 way = glm::normalize(s.lights[i].position - s.framing.floor.middle);
    lit +=
        s.framing.floor.diffuse * s.lights[i].color * static_cast<float>(glm::dot(way, s.framing.floor.up));
  }
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(lit[k], s.background[k], 1e-5);
  set_view(s, {.background = vec3(0)}, 1);
  EXPECT_EQ(s.framing.floor.radius, 0) << "nobody sees a black floor before black";
}

TEST(Studio, ASkyOfTheFilesOwnStays) {
  Scene s = in_studio({dvec3(-1), dvec3(1)});
  s.sky = {.kind = SkyKind::gradient, .stops = {{0, vec3(0.5f)}}};
  s.framing.studio->own_background = true;
  set_view(s, {}, 1);
  EXPECT_EQ(s.sky.stops.size(), 1u);
  EXPECT_EQ(s.framing.floor.radius, 0);
  EXPECT_EQ(s.lights.size(), 3u);
}

TEST(Studio, ARoomIsLitFromWithinAndHasItsOwnFloor) {
  const DBox box{dvec3(0), dvec3(8, 3, 6)};
  Scene s = in_studio(box);
  s.framing.studio->room = {.from = {7, 1.4, 5}, .at = {4, 1.3, 3}};
  set_view(s, {}, 1);
  EXPECT_EQ(s.camera->from, dvec3(7, 1.4, 5));
  EXPECT_EQ(s.camera->at, dvec3(4, 1.3, 3));
  EXPECT_EQ(s.framing.floor.radius, 0);
  EXPECT_EQ(s.lights.size(), 2u);
  for (const Light& light : s.lights) EXPECT_TRUE(contains(box, light.position));
  // From outside it is an object.
  set_view(s, {.from = dvec3(30, 20, 30)}, 1);
  EXPECT_GT(s.framing.floor.radius, 0);
  EXPECT_EQ(s.lights.size(), 3u);
  // One open on a side is seen straight through it.
  s.framing.studio->room.reset();
  s.framing.studio->open_to = dvec3(0, 0, 1);
  set_view(s, {}, 1);
  EXPECT_GT(s.camera->from.z, 6);
  EXPECT_NEAR(s.camera->from.x, 4, 1e-9);
  EXPECT_EQ(s.framing.floor.radius, 0);
}

}  // namespace
}  // namespace kdray::scene
