// What    What is written for POV-Ray and read from it; a picture by POV-Ray itself where it is installed.
#include "bench/povray/povray.h"

#include <gtest/gtest.h>

#include <sstream>

#include "bench/povray/povray.h"

namespace kdray::bench {
namespace {

scene::Scene small_scene() {
  scene::Scene s;
  s.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  s.triangles.emplace_back().vertex = {0, 1, 2};
  s.spheres.push_back({.center = {0, 0, 1}, .radius = 0.5, .number = 1});
  s.cones.push_back(
      {.base = {0, 0, 0}, .apex = {0, 0, 2}, .base_radius = 0.25, .apex_radius = 0.125, .number = 2});
  s.discs.push_back({.center = {3, 0, 0}, .normal = {0, 0, 2}, .radius = 0.75, .number = 3});
  s.tori.push_back(
      {.center = {1, 0, 0}, .axis = {0, 0, 3}, .major_radius = 0.5, .minor_radius = 0.125, .number = 4});
  s.materials.emplace_back().diffuse = {0.5f, 0.25f, 0};
  s.lights.emplace_back().position = {1, 2, 3};
  s.camera = {.from = {0, -5, 2}, .at = {0, 0, 1}, .up = {0, 0, 1}};
  return s;
}

TEST(Povray, FileHoldsTheScene) {
  std::ostringstream out;
  write_pov(out, small_scene(), 2, 5, 0.001);
  const std::string text = out.str();
  for (const char* const part :
       {"max_trace_level 5", "sphere { <0,0,1>,0.5", "cone { <0,0,0>,0.25,<0,0,2>,0.125 open",
        "disc { <3,0,0>,<0,0,2>,0.75", "torus { 0.5,0.125 matrix <0,1,0,0,0,1,1,0,0,1,0,0> ",
        "triangle {<-1,-1,0>,<1,-1,0>,<0,1,0>}", "light_source { <1,2,3>", "rgbf <1,0.5,0,0>", "diffuse 0.5",
        "right <-2,0,0>"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " is not in\n" << text;
}

TEST(Povray, TraceTimeIsReadFromItsOutput) {
  EXPECT_EQ(
      trace_time_in(
          "x\n  Trace Time:       0 hours  0 minutes  1 seconds (1.350 seconds)\n              using 2"),
      1.35);
  EXPECT_LT(trace_time_in("Parse Time: 0 seconds (0.2 seconds)"), 0);
  EXPECT_LT(trace_time_in("Trace Time: no\n (3 seconds)"), 0);
  EXPECT_LT(trace_time_in(""), 0);
}

TEST(Povray, LightsThatFadeBecomeItsOwn) {
  scene::Scene s = small_scene();
  s.lights[0].attenuation = {2, 0, 8};
  s.lights[0].color = {4, 8, 12};
  std::ostringstream out;
  write_pov(out, s, 1, 5, 0);
  // 2 / (1 + (d / 0.5)^2) * (1, 2, 3) = (4, 8, 12) / (2 + 8 d^2)
  EXPECT_NE(out.str().find("rgb <1,2,3> fade_distance 0.5 fade_power 2"), std::string::npos) << out.str();
}

TEST(Povray, KnowsWhatItHasNoWordsFor) {
  EXPECT_TRUE(pov_has_words_for(small_scene()));
  scene::Scene s = small_scene();
  s.lights[0].attenuation = {1, 0, 0.5f};
  EXPECT_TRUE(pov_has_words_for(s));
  s.lights[0].attenuation = {1, 0.5f, 0};
  EXPECT_FALSE(pov_has_words_for(s));
  s = small_scene();
  s.lights[0].range = 3;
  EXPECT_FALSE(pov_has_words_for(s));
  s = small_scene();
  s.lights[0].kind = scene::LightKind::spot;
  EXPECT_FALSE(pov_has_words_for(s));
  s = small_scene();
  s.materials[0].emission = {1, 0, 0};
  EXPECT_FALSE(pov_has_words_for(s));
}

// The light goes above white, where a PNG would cut it off.
TEST(Povray, GivesItsPictureInLinearLight) {
  if (!has_povray()) GTEST_SKIP() << "povray is not installed";
  scene::Scene s = small_scene();
  s.background = {3, 0.5f, 0.25f};
  s.camera->at = {0, -10, 2};  // away from everything
  const Povray::Traced traced = Povray(s, 24, 16, 5, 0.001).trace(1, {"+AM2", "+A0.1", "+R2"});
  EXPECT_GE(traced.seconds, 0);
  ASSERT_EQ(traced.image.width, 24);
  ASSERT_EQ(traced.image.height, 16);
  for (const vec3& p : traced.image.pixels) {
    EXPECT_NEAR(p.x, 3, 0.002);
    EXPECT_NEAR(p.y, 0.5, 0.0003);
    EXPECT_NEAR(p.z, 0.25, 0.0002);
  }
}

TEST(Povray, TracesTheFile) {
  if (!has_povray()) GTEST_SKIP() << "povray is not installed";
  EXPECT_GE(Povray(small_scene(), 16, 16, 5, 0.001).trace_seconds(1), 0);
}

}  // namespace
}  // namespace kdray::bench
