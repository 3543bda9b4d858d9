#include "scene/model/frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include <random>

namespace kdray::scene {
namespace {

Scene box_of(const dvec3& lo, const dvec3& hi) {
  Scene s;
  s.materials.emplace_back();
  s.vertices = {lo, hi, {lo.x, hi.y, lo.z}};
  s.triangles = {{.vertex = {0, 1, 2}}};
  return s;
}

// Where a point falls in the picture: -1 to 1 across and up; needs to lie in front of the eye.
glm::dvec2 project(const Camera& c, double aspect, const dvec3& p) {
  const dvec3 f = glm::normalize(c.at - c.from);
  const dvec3 r = glm::normalize(glm::cross(f, c.up));
  const dvec3 u = glm::cross(r, f);
  const double depth = glm::dot(p - c.from, f);
  EXPECT_GT(depth, c.hither);
  const double t = std::tan(c.vertical_fov / 2) * depth;
  return {glm::dot(p - c.from, r) / (t * aspect), glm::dot(p - c.from, u) / t};
}

TEST(FrameScene, ShowsTheWholeBoxAndFillsThePicture) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    const dvec3 lo = (dvec3(unit(random), unit(random), unit(random)) - 0.5) * 1e6;
    const dvec3 hi =
        lo + dvec3(unit(random), unit(random), unit(random)) * std::pow(10, 6 * unit(random) - 3);
    Scene s = box_of(lo, hi);
    const double aspect = seed % 2 ? 0.4 : 1;
    if (seed % 2) s.settings.width = 400, s.settings.height = 1000;
    frame_scene(s);
    ASSERT_TRUE(s.camera);
    ASSERT_EQ(s.lights.size(), 2u);
    double reach = 0;
    for (int i = 0; i < 8; ++i) {
      const glm::dvec2 q =
          project(*s.camera, aspect, {i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z});
      reach = std::max({reach, std::abs(q.x), std::abs(q.y)});
    }
    EXPECT_LT(reach, 0.97);
    EXPECT_GT(reach, 0.9) << "the picture should not be mostly empty";
  }
}

TEST(FrameScene, AnUnsizedPictureHasTheAspectRatioOfItsCamera) {
  const auto size = [](double aspect, std::optional<int> width = {}) {
    Scene s;
    s.camera.emplace().aspect = aspect;
    s.settings.width = width;
    const RenderSettings settings = settings_of(s);
    return std::pair(settings.width, settings.height);
  };
  using Sides = std::pair<std::optional<int>, std::optional<int>>;
  EXPECT_EQ(size(0), Sides());
  EXPECT_EQ(size(16.0 / 9), Sides(1024, 576));
  EXPECT_EQ(size(0.5), Sides(512, 1024));
  EXPECT_EQ(size(1), Sides(1024, 1024));
  EXPECT_EQ(size(1e300), Sides(1024, 1));
  EXPECT_EQ(size(1e-300), Sides(1, 1024));
  EXPECT_EQ(size(2, 640), Sides(640, std::nullopt)) << "the file's own size counts";
}

TEST(FrameScene, AWidthAloneHasTheHeightOfTheAspectRatio) {
  const auto size = [](RenderSettings settings, int width, int height) {
    set_size(settings, width, height);
    return std::pair(settings.width, settings.height);
  };
  using Sides = std::pair<std::optional<int>, std::optional<int>>;
  RenderSettings wide;
  wide.width = 1024, wide.height = 576;
  EXPECT_EQ(size(wide, 256, 0), Sides(256, 144));
  EXPECT_EQ(size(wide, 0, 144), Sides(256, 144));
  EXPECT_EQ(size(wide, 256, 256), Sides(256, 256));
  EXPECT_EQ(size(wide, 1, 0), Sides(1, 1));
  EXPECT_EQ(size(wide, 0, 0), Sides(1024, 576));
  EXPECT_EQ(size({}, 256, 0), Sides(256, 256));
  EXPECT_EQ(size({}, 0, 0), Sides());
}

TEST(FrameScene, LightsSidesTheCameraSees) {
  Scene s = box_of(dvec3(-1), dvec3(1));
  frame_scene(s);
  float sum = 0;
  for (const Light& l : s.lights) {
    EXPECT_EQ(l.kind, LightKind::directional);
    EXPECT_NEAR(glm::length(l.direction), 1, 1e-12);
    EXPECT_LT(glm::dot(glm::normalize(s.camera->from - s.camera->at), l.direction), -0.5);
    sum += l.color.x;
  }
  EXPECT_FLOAT_EQ(sum, 1);
}

TEST(FrameScene, LeavesWhatTheFileSaid) {
  Scene s = box_of(dvec3(-1), dvec3(1));
  s.camera = Camera{.from = dvec3(0, 0, 9)};
  frame_scene(s);
  EXPECT_EQ(s.camera->from, dvec3(0, 0, 9));
  EXPECT_EQ(s.lights.size(), 2u);
  Scene lit = box_of(dvec3(-1), dvec3(1));
  lit.lights.emplace_back();
  frame_scene(lit);
  EXPECT_TRUE(lit.camera);
  EXPECT_EQ(lit.lights.size(), 1u);
  Scene dark = box_of(dvec3(-1), dvec3(1));
  dark.unlit = true;
  frame_scene(dark);
  EXPECT_TRUE(dark.camera);
  EXPECT_TRUE(dark.lights.empty());
}

TEST(FrameScene, PutsLampsIntoARoom) {
  Scene s = box_of(dvec3(-10), dvec3(10));
  s.camera = Camera{.from = dvec3(0, 1, 5)};
  frame_scene(s);
  ASSERT_EQ(s.lights.size(), 2u);
  for (const Light& l : s.lights) {
    EXPECT_EQ(l.kind, LightKind::point);
    EXPECT_LT(glm::length(l.position - s.camera->from), 1);
  }
}

// A model of many triangles on a ground plane a thousand times its size.
TEST(FrameScene, LooksAtTheModelAndNotAtAHugeGround) {
  Scene s;
  const auto add = [&](const dvec3& a, const dvec3& b, const dvec3& c) {
    const auto first = static_cast<std::uint32_t>(s.vertices.size());
    s.vertices.insert(s.vertices.end(), {a, b, c});
    Triangle t;
    t.vertex = {first, first + 1, first + 2};
    t.number = first / 3;
    s.triangles.push_back(t);
  };
  for (int i = 0; i < 500; ++i) {
    const dvec3 p(std::cos(i), 1 + std::sin(3.0 * i), std::sin(i));
    add(p, p + dvec3(0.1, 0, 0), p + dvec3(0, 0.1, 0));
  }
  Scene alone = s;
  frame_scene(alone);
  EXPECT_TRUE(alone.warnings.empty());
  add({-1000, 0, -1000}, {1000, 0, -1000}, {1000, 0, 1000});
  add({-1000, 0, -1000}, {1000, 0, 1000}, {-1000, 0, 1000});
  frame_scene(s);
  EXPECT_LT(glm::length(s.camera->from - alone.camera->from), 1);
  EXPECT_EQ(s.warnings.size(), 1u);
  EXPECT_EQ(s.lights.size(), 2u);
}

TEST(FrameScene, TakesAPointAndNothing) {
  Scene point = box_of(dvec3(5), dvec3(5));
  frame_scene(point);
  EXPECT_GT(glm::length(point.camera->from - point.camera->at), 0.5);
  Scene empty;
  frame_scene(empty);
  EXPECT_TRUE(empty.camera);
  EXPECT_TRUE(empty.lights.empty());
}

}  // namespace
}  // namespace kdray::scene
