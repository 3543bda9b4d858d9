// What    What is written for POV-Ray and read from it; a picture by POV-Ray itself where it is installed.
#include "bench/povray.h"

#include <gtest/gtest.h>

#include <sstream>

#include "bench/pov_writer.h"

namespace kdray::bench {
namespace {

scene::Scene small_scene() {
  scene::Scene s;
  s.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  s.triangles.emplace_back().vertex = {0, 1, 2};
  s.spheres.push_back({.center = {0, 0, 1}, .radius = 0.5, .number = 1});
  s.cones.push_back(
      {.base = {0, 0, 0}, .apex = {0, 0, 2}, .base_radius = 0.25, .apex_radius = 0.125, .number = 2});
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

TEST(Povray, TracesTheFile) {
  if (!has_povray()) GTEST_SKIP() << "povray is not installed";
  EXPECT_GE(Povray(small_scene(), 16, 16, 5, 0.001).trace_seconds(1), 0);
}

}  // namespace
}  // namespace kdray::bench
