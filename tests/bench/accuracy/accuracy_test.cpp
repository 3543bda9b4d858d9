// What    The parts of bench accuracy that need no device: the settings, the lights' reach, pictures as they
//         are shown, reports.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "bench/accuracy/answers.h"
#include "bench/accuracy/bench.h"
#include "bench/accuracy/settings.h"
#include "bench/accuracy/shown.h"

namespace kdray::bench {
namespace {

constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
constexpr float kEndless = std::numeric_limits<float>::infinity();

TEST(AccuracySettings, BeginWithTheBaseAndHaveNamesOfTheirOwn) {
  for (const SettingsWanted& wanted :
       {SettingsWanted{true, true, true, false}, SettingsWanted{false, false, false, true}}) {
    const std::vector<Setting> all = accuracy_settings(wanted);
    ASSERT_GE(all.size(), 6u);
    EXPECT_EQ(all.front().samples, 16);
    EXPECT_EQ(all.front().depth, 16);
    std::set<std::string> names;
    for (const Setting& s : all) {
      EXPECT_TRUE(names.insert(s.name).second) << s.name << " is there twice";
      EXPECT_FALSE(s.label.empty()) << s.name;
      EXPECT_FALSE(s.group.empty()) << s.name;
    }
  }
}

// Beside the samples, drafts and the default depth, whose group says what they have in common.
TEST(AccuracySettings, ChangeOneThingAtATimeFromTheBase) {
  const std::vector<Setting> all = accuracy_settings({true, true, true, false});
  const Setting& base = all.front();
  std::size_t n = 0;
  for (const Setting& s : all) {
    if (s.group.rfind("base", 0) != 0) continue;
    ++n;
    EXPECT_EQ((s.samples != base.samples) + (s.depth != base.depth) + (s.min_weight != base.min_weight) +
                  (s.light_reach != base.light_reach) + (s.precision != base.precision) +
                  (s.traversal != base.traversal) + (s.quality != base.quality),
              1)
        << s.name;
    EXPECT_EQ(keeps_the_picture(s.group), s.traversal != base.traversal || s.quality != base.quality);
  }
  EXPECT_EQ(n, 4u + 4 + 1 + 4 + 6);
}

TEST(AccuracySettings, LeaveOutWhatMakesNoDifference) {
  for (const Setting& s : accuracy_settings({false, false, false, false})) {
    EXPECT_EQ(s.light_reach, 0) << s.name;
    EXPECT_EQ(s.precision, Precision::float32) << s.name;
    EXPECT_NE(s.traversal, Traversal::packet) << s.name;
    EXPECT_NE(s.traversal, Traversal::batch) << s.name;
  }
}

double strength(const scene::Light& light, double d) {
  return light.color.x / (light.attenuation.x + d * (light.attenuation.y + d * light.attenuation.z));
}

TEST(LightReach, EndsWhereALightHasBecomeThatWeak) {
  for (const vec3& attenuation : {vec3(1, 0, 0.15f), vec3(0, 2, 0), vec3(0.5f, 0.25f, 0.125f), vec3(0, 0, 3)})
    for (const double least : {0.2, 0.01}) {
      scene::Scene s;
      s.lights.emplace_back().attenuation = attenuation;
      s.lights[0].color = vec3(2, 1, 0);
      EXPECT_TRUE(has_fading_lights(s));
      limit_lights(s, least);
      EXPECT_NEAR(strength(s.lights[0], s.lights[0].range), least, 1e-9);
    }
}

TEST(LightReach, ChangesOnlyWhatFadesAndNeverLengthensARange) {
  scene::Scene s;
  s.lights.resize(4);
  s.lights[1].kind = scene::LightKind::directional;
  s.lights[1].attenuation = {0, 0, 1};
  EXPECT_FALSE(has_fading_lights(s));
  s.lights[2].attenuation = s.lights[3].attenuation = {1, 0, 1};
  s.lights[2].range = 0.5;
  s.lights[3].color = vec3(0.05f);
  EXPECT_TRUE(has_fading_lights(s));
  limit_lights(s, 0.1);
  EXPECT_TRUE(std::isinf(s.lights[0].range));
  EXPECT_TRUE(std::isinf(s.lights[1].range));
  EXPECT_EQ(s.lights[2].range, 0.5);
  EXPECT_LT(s.lights[3].range, 1e-30);  // too weak from the start
  EXPECT_GT(s.lights[3].range, 0);
}

TEST(Shown, IsBetweenBlackAndWhite) {
  const Picture picture{2, 1, {-1, 0.5f, 7, kNoNumber, kEndless, -kEndless}, {}, {}};
  const image::Image image = shown(image_of(picture));
  EXPECT_EQ(image.width, 2);
  EXPECT_EQ(image.height, 1);
  ASSERT_EQ(image.pixels.size(), 2u);
  EXPECT_EQ(image.pixels[0], vec3(0, 0.5f, 1));
  EXPECT_EQ(image.pixels[1], vec3(0, 1, 0));
}

TEST(Shown, ShrinksToTheMean) {
  image::Image image{4, 2, {}};
  for (int i = 0; i < 8; ++i) image.pixels.emplace_back(static_cast<float>(i), 1, 0);
  const image::Image small = shrunk(image, 2);
  ASSERT_EQ(small.pixels.size(), 2u);
  EXPECT_EQ(small.pixels[0], vec3((0 + 1 + 4 + 5) / 4.0f, 1, 0));
  EXPECT_EQ(small.pixels[1], vec3((2 + 3 + 6 + 7) / 4.0f, 1, 0));
}

TEST(Shown, ErrorsAreBlackWhereThereAreNoneAndOnOneScale) {
  const image::Image a{3, 1, {vec3(0.5f), vec3(0), vec3(0)}},
      b{3, 1, {vec3(0.5f), vec3(0, 0.25f, 0), vec3(1)}};
  const image::Image map = error_picture(a, b), same = error_picture(a, a);
  EXPECT_EQ(map.pixels[0], same.pixels[0]);
  EXPECT_EQ(map.pixels[0], vec3(0));
  EXPECT_LT(map.pixels[1].x, map.pixels[2].x);
  // The same difference has the same colour beside a smaller largest one.
  const image::Image c{3, 1, {vec3(0.5f), vec3(0, 0.25f, 0), vec3(0)}};
  EXPECT_EQ(error_picture(a, c).pixels[1], map.pixels[1]);
}

AccuracyPoint point(const char* group, const char* name, double seconds, double rmse) {
  AccuracyPoint p{group, name, "label", {}, {seconds, seconds, seconds}, {}, 0, {}, false};
  p.error.rmse = rmse;
  return p;
}

AccuracyRun small_run() {
  AccuracyRun run;
  run.scene = "folder/a scene.nff";
  run.points = {point("samples at depth 16", "base", 1, 0.01), point("samples at depth 16", "one", 0.1, 0.05),
                point("base, other depth", "depth 3", 2, 0.02)};
  run.povray.emplace();
  run.povray->points = {point(kPovray, "+A0.3", 5, 0.03), point(kPovray, "+A0.1", 50, 0.001)};
  mark_front(run.points), mark_front(run.povray->points);
  return run;
}

// nlohmann writes what is not finite as null, which a reader would take for "there is none".
void expect_finite(const Json& json, const std::string& where) {
  EXPECT_TRUE(!json.is_number() || std::isfinite(json.get<double>())) << where;
  if (!json.is_structured()) return;
  for (const auto& [key, value] : json.items()) expect_finite(value, where + "/" + key);
}

TEST(AccuracyReport, FindsTheFastestThatIsNoWorse) {
  const AccuracyRun run = small_run();
  EXPECT_EQ(fastest_within(run.points, 0.03)->name, "base");
  EXPECT_EQ(fastest_within(run.points, 0.05)->name, "one");
  EXPECT_EQ(fastest_within(run.points, 0.001), nullptr);
  EXPECT_TRUE(run.points[0].on_front);
  EXPECT_TRUE(run.points[1].on_front);
  EXPECT_FALSE(run.points[2].on_front);
}

TEST(AccuracyReport, HoldsPovrayAgainstTheFastestThatIsNoWorse) {
  const std::vector<AccuracyRun> runs = {small_run()};
  const Json json = json_of(runs, AccuracyOptions{});
  expect_finite(json, "");
  const Json& points = json["runs"][0]["povray"]["points"];
  EXPECT_EQ(points[0]["kdray"], "base");
  EXPECT_EQ(points[0]["times_kdray"], 5);
  EXPECT_TRUE(points[1]["kdray"].is_null());
  EXPECT_TRUE(points[1]["times_kdray"].is_null());
  EXPECT_NE(table_of(runs[0]).find("5.0 times as long as kdray's base"), std::string::npos)
      << table_of(runs[0]);
}

TEST(AccuracyReport, StaysFiniteWhereAClockStoodStill) {
  AccuracyRun run = small_run();
  for (AccuracyPoint& p : run.points) p.seconds = {0, 0, 0};
  expect_finite(json_of(std::span(&run, 1), AccuracyOptions{}), "");
  EXPECT_EQ(table_of(run).find("nan"), std::string::npos) << table_of(run);
  EXPECT_EQ(table_of(run).find("inf"), std::string::npos) << table_of(run);
}

// Time and error are both halved or doubled from point to point, so between them time times error is
// constant.
AccuracyRun run_with_adaptive() {
  AccuracyRun run = small_run();
  const std::string group = "adaptive at depth 16";
  for (const double seconds : {0.05, 0.1, 0.2, 0.4}) {
    run.points.push_back(point(group.c_str(), "adaptive", seconds, 0.002 / seconds));
    run.points.back().taken = Taken{3.5, 0.03};
  }
  return run;
}

TEST(AccuracyAnswers, ReadTimesOffTheLineBetweenAdaptivePoints) {
  AccuracyRun run = run_with_adaptive();
  ASSERT_TRUE(is_adaptive(run.points.back().group));
  for (const double error : {0.04, 0.03, 0.02, 0.011, 0.005})
    EXPECT_NEAR(adaptive_seconds(run.points, error).value_or(0), 0.002 / error, 1e-12) << error;
  EXPECT_EQ(adaptive_seconds(run.points, 0.5), 0.05) << "above the largest error: the fastest point";
  EXPECT_FALSE(adaptive_seconds(run.points, 0.0049)) << "nothing is promised below the least";
  // A point that is both slower and worse than another doesn't count.
  run.points.push_back(point(run.points.back().group.c_str(), "worse", 0.39, 0.03));
  EXPECT_NEAR(adaptive_seconds(run.points, 0.03).value_or(0), 0.002 / 0.03, 1e-12);
}

TEST(AccuracyAnswers, AreInTheReport) {
  AccuracyRun run = run_with_adaptive();
  run.povray->points.push_back(point(kPovray, "-A, depth 5", 0.001, 0.04));  // no antialiasing
  run.povray->points.push_back(point(kPovray, "+A0.2", 3, 0.02));
  const AdaptiveAnswers a = adaptive_answers(run);
  EXPECT_NEAR(a.share_of_base.value_or(0), 0.2, 1e-12);
  ASSERT_NE(a.povray, nullptr);
  EXPECT_EQ(a.povray->name, "+A0.2")
      << "30 times as long; +A0.3 takes 75 times, +A0.1 is nearer than any of kdray's";
  EXPECT_NEAR(a.times_povray, 30, 1e-9);
  EXPECT_NE(
      table_of(run).find("adaptive has the base's RMSE in 0.20 of its time; POV-Ray's best at equal RMSE, "
                         "+A0.2, takes 30.0 times as long"),
      std::string::npos)
      << table_of(run);
  const Json json = json_of(std::span(&run, 1), AccuracyOptions{});
  expect_finite(json, "");
  EXPECT_EQ(json["runs"][0]["adaptive"]["povray"], "+A0.2");
  EXPECT_EQ(json["runs"][0]["points"].back()["believed_rmse"], 0.03);
  EXPECT_EQ(json["runs"][0]["points"].back()["samples"], 3.5);
  EXPECT_TRUE(json["runs"][0]["points"][0]["believed_rmse"].is_null());
}

TEST(AccuracyAnswers, AreMissingWhereAdaptiveSamplingDoesNotComeAsNear) {
  AccuracyRun run = run_with_adaptive();
  run.points[0].error.rmse = 0.001;
  run.povray->points = {point(kPovray, "+A0.1", 50, 0.001)};
  EXPECT_FALSE(adaptive_answers(run).share_of_base);
  EXPECT_EQ(adaptive_answers(run).povray, nullptr);
  EXPECT_NE(table_of(run).find("adaptive does not come as near as the base"), std::string::npos)
      << table_of(run);
  EXPECT_TRUE(
      json_of(std::span(&run, 1), AccuracyOptions{})["runs"][0]["adaptive"]["share_of_base"].is_null());
}

TEST(AccuracyReport, CountsPicturesThatAreNotTheBases) {
  std::vector<AccuracyRun> runs = {small_run()};
  const std::vector<Setting> settings = accuracy_settings({});
  runs[0].points.push_back(point(settings.back().group.c_str(), "best tree", 1, 0.01));
  EXPECT_EQ(count_unlike_base(runs), 0u);
  runs[0].points.back().change = 1e-9;
  EXPECT_EQ(count_unlike_base(runs), 1u);
  runs[0].points[1].change = 1;  // other samples may well change the picture
  EXPECT_EQ(count_unlike_base(runs), 1u);
}

TEST(AccuracyReport, NamesPicturesSoThatEveryFileSystemTakesThem) {
  EXPECT_EQ(picture_name("../a scene.nff", "1 sample, depth 5 (defaults)"),
            "a_scene_1_sample_depth_5_defaults.png");
  EXPECT_EQ(picture_name("balls", "POV-Ray +AM2 +A0.1"), "balls_POV-Ray_+AM2_+A0.1.png");
}

}  // namespace
}  // namespace kdray::bench
