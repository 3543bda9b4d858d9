// What    glTF animations, morph targets and skins against poses in closed form: cubics are what cubic
//         splines reproduce, turns about an axis are what spherical interpolation halves, and an arm of two
//         joints bends where trigonometry says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "base/error.h"
#include "scene/gltf_samples.h"
#include "scene/import/load.h"
#include "scene/model/check_scene.h"
#include "scene/scratch.h"
#include "support/data.h"

namespace kdray::scene {
namespace {

using nlohmann::json;
using test::bytes_of;
using test::GltfSample;
using test::square;

constexpr double kPi = std::numbers::pi;

#define EXPECT_SAYS(message, part) EXPECT_NE((message).find(part), std::string::npos) << (message)

Scene at(const GltfSample& sample, std::optional<double> time, const std::string& animation = "") {
  Scene scene = read_gltf(sample.text(), "a.gltf", {.time = time, .animation = animation});
  check_scene(scene);
  return scene;
}
std::string refused(const GltfSample& sample) {
  return test::refusal([&] { at(sample, 0.5); });
}

void expect_near(const dvec3& got, const dvec3& wanted, double error = 1e-6) {
  EXPECT_LT(glm::length(got - wanted), error) << got.x << " " << got.y << " " << got.z << " instead of "
                                              << wanted.x << " " << wanted.y << " " << wanted.z;
}

// A channel of the animation with this number, whose values have as many components as their type.
void animate(GltfSample& sample, int node, const char* path, const std::vector<float>& times,
             const std::vector<float>& values, const char* way = nullptr, std::size_t animation = 0) {
  const std::string where = path;
  const char* const type = where == "weights" ? "SCALAR" : where == "rotation" ? "VEC4" : "VEC3";
  const std::size_t n = where == "weights" ? 1 : where == "rotation" ? 4 : 3;
  const int input = sample.accessor(sample.view(bytes_of(times)), 5126, "SCALAR", times.size());
  const int output = sample.accessor(sample.view(bytes_of(values)), 5126, type, values.size() / n);
  json& a = sample.json["animations"][animation];
  json sampler = {{"input", input}, {"output", output}};
  if (way) sampler["interpolation"] = way;
  a["samplers"].push_back(sampler);
  a["channels"].push_back(
      {{"sampler", a["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
}

std::vector<float> turn(double degrees, const dvec3& axis = {0, 0, 1}) {
  const double half = degrees * kPi / 360;
  const dvec3 v = std::sin(half) * axis;
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z),
          static_cast<float>(std::cos(half))};
}

std::vector<float> operator+(std::vector<float> a, const std::vector<float>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(GltfAnimation, MovesNodesAlongStraightLines) {
  GltfSample sample = square();
  animate(sample, 0, "translation", {1, 3}, {0, 0, 0, 4, 8, -2});
  expect_near(at(sample, 1.5).vertices[0], {1, 2, -0.5});
  expect_near(at(sample, 0).vertices[0], {0, 0, 0});
  expect_near(at(sample, 99).vertices[0], {4, 8, -2});
  // Without a time the node is where the file has it.
  sample.json["nodes"][0]["translation"] = {7, 0, 0};
  const Scene rest = at(sample, std::nullopt);
  expect_near(rest.vertices[0], {7, 0, 0});
  ASSERT_EQ(rest.warnings.size(), 1u);
  EXPECT_SAYS(rest.warnings[0], "1 animation is at rest; --time SECONDS shows a moment of one");
  EXPECT_TRUE(at(sample, 2).warnings.empty());
}

TEST(GltfAnimation, StepsStayUntilTheNext) {
  GltfSample sample = square();
  animate(sample, 0, "scale", {1, 2, 3}, {1, 1, 1, 2, 2, 2, 5, 5, 5}, "STEP");
  expect_near(at(sample, 1.999).vertices[2], {1, 1, 0});
  expect_near(at(sample, 2).vertices[2], {2, 2, 0});
  expect_near(at(sample, 2.5).vertices[2], {2, 2, 0});
  expect_near(at(sample, 3).vertices[2], {5, 5, 0});
}

// Half of the way is half of the angle; -q is the same rotation, and the shorter arc is taken.
TEST(GltfAnimation, TurnsAtAConstantSpeed) {
  for (const float sign : {1.0f, -1.0f}) {
    GltfSample sample = square();
    std::vector<float> last = turn(170);
    for (float& part : last) part *= sign;
    animate(sample, 0, "rotation", {0, 1}, turn(0) + last);
    for (const double t : {0.0, 0.1, 0.3, 0.77, 1.0}) {
      const double angle = 170 * kPi / 180 * t;
      expect_near(at(sample, t).vertices[1], {std::cos(angle), std::sin(angle), 0});
    }
  }
}

TEST(GltfAnimation, SmallTurnsAndUnevenQuaternionsAreTurns) {
  GltfSample sample = square();
  std::vector<float> first = turn(10), last = turn(10.00001);
  for (float& part : first) part *= 3;
  animate(sample, 0, "rotation", {0, 1}, first + last);
  const double angle = 10.000005 * kPi / 180;
  expect_near(at(sample, 0.5).vertices[1], {std::cos(angle), std::sin(angle), 0});
}

TEST(GltfAnimation, QuaternionsMayBeShortIntegers) {
  GltfSample sample = square();
  animate(sample, 0, "rotation", {0, 1}, turn(0) + turn(90));
  std::vector<std::int16_t> values;
  for (const float part : turn(0) + turn(90))
    values.push_back(static_cast<std::int16_t>(std::lround(part * 32767)));
  const int view = sample.view(bytes_of(values));
  json& accessor = sample.json["accessors"].back();
  accessor["bufferView"] = view;
  accessor["componentType"] = 5122;
  accessor["normalized"] = true;
  expect_near(at(sample, 0.5).vertices[1], {std::sqrt(0.5), std::sqrt(0.5), 0}, 1e-4);
}

// A cubic's values and slopes at any keyframes give that cubic between them.
TEST(GltfAnimation, CubicSplinesReproduceCubics) {
  const auto place = [](double t) {
    return dvec3(1 - 2 * t + t * t * t, 3 * t * t, 0.5 * t * t * t - t * t);
  };
  const auto slope = [](double t) { return dvec3(-2 + 3 * t * t, 6 * t, 1.5 * t * t - 2 * t); };
  const std::vector<float> times = {-0.5f, 0.25f, 2};
  std::vector<float> values;
  for (const double t : times)
    for (const dvec3& v : {slope(t), place(t), slope(t)})
      for (int c = 0; c < 3; ++c) values.push_back(static_cast<float>(v[c]));
  GltfSample sample = square();
  animate(sample, 0, "translation", times, values, "CUBICSPLINE");
  for (const double t : {-0.5, -0.2, 0.25, 0.3, 1.0, 1.9, 2.0})
    expect_near(at(sample, t).vertices[0], place(t), 1e-5);
  expect_near(at(sample, 5).vertices[0], place(2), 1e-5);
}

// With slopes of 0 a turn is eased in and out: half of it at half time, and unit quaternions all the way.
TEST(GltfAnimation, CubicSplinesOfRotationsStayRotations) {
  const std::vector<float> zero = {0, 0, 0, 0};
  GltfSample sample = square();
  animate(sample, 0, "rotation", {0, 2}, zero + turn(0) + zero + zero + turn(90) + zero, "CUBICSPLINE");
  expect_near(at(sample, 1).vertices[1], {std::sqrt(0.5), std::sqrt(0.5), 0});
  for (const double t : {0.3, 0.9, 1.6}) EXPECT_NEAR(glm::length(at(sample, t).vertices[1]), 1, 1e-9);
}

// ---- Morph targets

GltfSample morphing() {
  GltfSample sample = square();
  auto& primitive = sample.primitive();
  primitive["attributes"]["NORMAL"] = sample.vectors({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int up = sample.vectors({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int out = sample.vectors({0, 0, 0, 2, 0, 0, 2, 0, 0, 0, 0, 0});
  const int tilt = sample.vectors({1, 0, -1, 1, 0, -1, 1, 0, -1, 1, 0, -1});
  primitive["targets"] = {{{"POSITION", up}, {"NORMAL", tilt}}, {{"POSITION", out}}};
  return sample;
}

TEST(GltfMorph, OffsetsAreAddedByTheirWeights) {
  GltfSample sample = morphing();
  expect_near(at(sample, std::nullopt).vertices[1], {1, 0, 0});
  sample.json["meshes"][0]["weights"] = {0.5, 0.25};
  Scene s = at(sample, std::nullopt);
  expect_near(s.vertices[1], {1.5, 0, 0.5});
  expect_near(s.vertices[3], {0, 1, 0.5});
  expect_near(s.normals[0], {std::sqrt(0.5), 0, std::sqrt(0.5)});
  // A node's weights come before its mesh's.
  sample.json["nodes"][0]["weights"] = {-1, 0};
  expect_near(at(sample, std::nullopt).vertices[1], {1, 0, -1});
  EXPECT_TRUE(at(sample, std::nullopt).warnings.empty());
}

TEST(GltfMorph, WeightsAreAnimated) {
  GltfSample sample = morphing();
  sample.json["nodes"][0]["translation"] = {0, 10, 0};
  animate(sample, 0, "weights", {0, 1}, {0, 1, 1, 0});
  expect_near(at(sample, 0.25).vertices[1], {1 + 2 * 0.75, 10, 0.25});
  animate(sample, 0, "weights", {0, 2}, {9, 9, 0, 0, 9, 9, 9, 9, 1, 4, 9, 9}, "CUBICSPLINE", 1);
  sample.json["animations"][1]["samplers"][0]["output"] =
      sample.accessor(sample.view(bytes_of<float>({0, 0, 0, 0, 1, 2, 1, 2, 2, 4, 0, 0})), 5126, "SCALAR", 12);
  // The straight lines w = t and 2 t, as their values and slopes say.
  expect_near(at(sample, 0.5, "1").vertices[1], {1 + 2 * 1.0, 10, 0.5});
}

TEST(GltfMorph, WhatDoesNotFitIsRefused) {
  GltfSample sample = morphing();
  sample.json["nodes"][0]["weights"] = {1};
  EXPECT_EQ(at(sample, std::nullopt).vertices[1], dvec3(1, 0, 1));  // the others are 0
  sample.primitive()["targets"][0]["POSITION"] = sample.vectors({0, 0, 1});
  EXPECT_SAYS(refused(sample), "/meshes/0/primitives/0/targets/0: 1 offsets for 4 vertices");
  sample = morphing();
  animate(sample, 0, "weights", {0, 1}, {0, 1, 1});
  EXPECT_SAYS(refused(sample), "/animations/0/samplers/0: its 2 keyframes want 4 values, and there are 3");
}

// ---- Skins

// An arm along x from 0 to 2, with a joint at 0 and one at 1; nodes 1 and 2. Where they meet, each has half.
GltfSample arm() {
  GltfSample sample = square();
  auto& primitive = sample.primitive();
  primitive["attributes"]["POSITION"] = sample.vectors({0, 0.1f, 0, 1, 0.1f, 0, 2, 0.1f, 0, 2, -0.1f, 0});
  primitive["attributes"]["NORMAL"] = sample.vectors({0, 1, 0, 0, 1, 0, 0, 1, 0, 0, -1, 0});
  primitive["attributes"]["JOINTS_0"] = sample.accessor(
      sample.view(bytes_of<std::uint8_t>({0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0})), 5121, "VEC4", 4);
  primitive["attributes"]["WEIGHTS_0"] = sample.accessor(
      sample.view(bytes_of<float>({1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0})), 5126, "VEC4", 4);
  const int inverse =
      sample.accessor(sample.view(bytes_of<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,
                                                   1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1})),
                      5126, "MAT4", 2);
  sample.json["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}},
                          {{"children", {2}}},
                          {{"translation", {1, 0, 0}}}};
  sample.json["scenes"][0]["nodes"] = {0, 1};
  sample.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", inverse}}};
  return sample;
}

TEST(GltfSkin, AtRestIsAsItWasBound) {
  const Scene s = at(arm(), std::nullopt);
  EXPECT_TRUE(s.warnings.empty());
  expect_near(s.vertices[0], {0, 0.1, 0});  // the node's own place doesn't count
  expect_near(s.vertices[1], {1, 0.1, 0});
  expect_near(s.vertices[2], {2, 0.1, 0});
}

TEST(GltfSkin, BendsAtTheElbow) {
  GltfSample sample = arm();
  animate(sample, 2, "rotation", {0, 1}, turn(0) + turn(90));
  const Scene s = at(sample, 1);
  expect_near(s.vertices[0], {0, 0.1, 0});
  expect_near(s.vertices[1], {0.95, 0.05, 0});  // halfway from (1, 0.1) to (0.9, 0)
  expect_near(s.vertices[2], {0.9, 1, 0});
  expect_near(s.vertices[3], {1.1, 1, 0});
  expect_near(s.normals[0], {0, 1, 0});
  expect_near(s.normals[1], {-std::sqrt(0.5), std::sqrt(0.5), 0});
  expect_near(s.normals[2], {-1, 0, 0});
  expect_near(s.normals[3], {1, 0, 0});
}

// The upper arm moves the lower one along, and what is above both moves both.
TEST(GltfSkin, JointsMoveWithTheirParents) {
  GltfSample sample = arm();
  sample.json["nodes"].push_back({{"children", {1}}, {"scale", {2, 2, 2}}});
  sample.json["scenes"][0]["nodes"] = {0, 3};
  animate(sample, 1, "rotation", {0, 1}, turn(0) + turn(90));
  expect_near(at(sample, 1).vertices[2], {-0.2, 4, 0});
}

// Weights that don't sum up to 1 are taken as shares, and a vertex without any moves with its node.
TEST(GltfSkin, WeightsAreShares) {
  GltfSample sample = arm();
  sample.primitive()["attributes"]["WEIGHTS_0"] = sample.accessor(
      sample.view(bytes_of<std::uint8_t>({0, 0, 0, 0, 100, 100, 0, 0, 9, 0, 0, 0, 255, 0, 0, 0})), 5121,
      "VEC4", 4);
  sample.json["accessors"].back()["normalized"] = true;
  const Scene s = at(sample, std::nullopt);
  expect_near(s.vertices[0], {100, 0.1, 0});
  expect_near(s.vertices[1], {1, 0.1, 0});
  expect_near(s.vertices[2], {2, 0.1, 0});
}

TEST(GltfSkin, MorphTargetsComeFirst) {
  GltfSample sample = arm();
  sample.primitive()["targets"] = {{{"POSITION", sample.vectors({0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0})}}};
  sample.json["nodes"][0]["weights"] = {1};
  animate(sample, 2, "rotation", {0, 1}, turn(0) + turn(90));
  expect_near(at(sample, 1).vertices[2], {0.9, 2, 0});
}

TEST(GltfSkin, WhatDoesNotFitIsRefused) {
  GltfSample sample = arm();
  sample.json["skins"][0]["joints"] = {1};
  EXPECT_SAYS(refused(sample), "/attributes/JOINTS_0: the skin has 1 joints, and a vertex asks for joint 1");
  sample = arm();
  sample.json["skins"][0]["joints"] = {1, 2, 2};
  EXPECT_SAYS(refused(sample), "/skins/0: 3 joints, but 2 inverse bind matrices");
  sample = arm();
  sample.json["skins"][0]["joints"] = {1, 7};
  EXPECT_SAYS(refused(sample), "/skins/0/joints/1: there is no 7 in /nodes");
  sample = arm();
  sample.json["nodes"].push_back({{"children", {4}}});
  sample.json["nodes"].push_back({{"children", {3}}});
  sample.json["skins"][0]["joints"] = {1, 3};
  EXPECT_SAYS(refused(sample), "/skins/0/joints/1: the node is inside itself");
  sample = arm();
  sample.primitive()["attributes"]["WEIGHTS_0"] = sample.accessor(0, 5126, "VEC4", 2);
  EXPECT_SAYS(refused(sample), "joints or weights that are not as many as the 4 positions");
}

// ---- Which of them

TEST(GltfAnimation, OneOfSeveralIsChosen) {
  GltfSample sample = square();
  animate(sample, 0, "translation", {0, 1}, {1, 0, 0, 1, 0, 0});
  animate(sample, 0, "scale", {0, 1}, {3, 3, 3, 3, 3, 3}, nullptr, 1);
  sample.json["animations"][1]["name"] = "grow";
  const Scene first = at(sample, 0);
  expect_near(first.vertices[2], {2, 1, 0});
  ASSERT_EQ(first.warnings.size(), 1u);
  EXPECT_SAYS(first.warnings[0],
              "of 2 animations the first is seen; --animation names another, or all: 0, 1 'grow'");
  for (const char* const name : {"1", "grow"}) expect_near(at(sample, 0, name).vertices[2], {3, 3, 0});
  expect_near(at(sample, 0, "all").vertices[2], {4, 3, 0});
  EXPECT_TRUE(at(sample, 0, "all").warnings.empty());
  try {
    at(sample, 0, "shrink");
    ADD_FAILURE() << "there is none";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::usage);
    EXPECT_SAYS(std::string(e.what()), "there is no animation 'shrink': a.gltf has 0, 1 'grow'");
  }
}

TEST(GltfAnimation, MovesCamerasAndLights) {
  GltfSample sample = square();
  sample.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}};
  sample.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  sample.json["nodes"].push_back({{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  sample.json["scenes"][0]["nodes"] = {0, 1};
  animate(sample, 1, "translation", {0, 1}, {0, 0, 5, 4, 0, 5});
  animate(sample, 1, "rotation", {0, 1}, turn(0, {0, 1, 0}) + turn(90, {0, 1, 0}));
  const Scene s = at(sample, 0.5);
  ASSERT_TRUE(s.camera);
  expect_near(s.camera->from, {2, 0, 5});
  expect_near(glm::normalize(s.camera->at - s.camera->from), {-std::sqrt(0.5), 0, -std::sqrt(0.5)});
  ASSERT_EQ(s.lights.size(), 1u);
  expect_near(s.lights[0].position, {2, 0, 5});
}

TEST(GltfAnimation, WhatIsAskedForInVainIsSaid) {
  const Scene still = at(square(), 1);
  ASSERT_EQ(still.warnings.size(), 1u);
  EXPECT_SAYS(still.warnings[0], "there is no animation: at any time it is the same");
  GltfSample sample = square();
  animate(sample, 0, "translation", {0, 1}, {0, 0, 0, 4, 8, -2});
  json& channels = sample.json["animations"][0]["channels"];
  channels.push_back({{"sampler", 0}, {"target", {{"path", "pointer"}}}});
  const Scene s = at(sample, 1);
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_SAYS(s.warnings[0],
              "1 animated value of something else than nodes (KHR_animation_pointer) is left out");
  channels[1]["target"] = {{"path", "translation"}};  // of nothing
  EXPECT_TRUE(at(sample, 1).warnings.empty());
  const test::ScratchFolder folder;
  const auto file = folder.write("a.ply",
                                 "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float "
                                 "y\nproperty float z\nend_header\n");
  const Scene ply = load(file, {.time = 1});
  EXPECT_TRUE(std::ranges::any_of(ply.warnings, [](const std::string& w) {
    return w.find("only glTF files have animations") != std::string::npos;
  }));
}

TEST(GltfAnimation, FaultsAreRefused) {
  GltfSample sample = square();
  animate(sample, 0, "translation", {0, 1}, {0, 0, 0, 4, 8, -2});
  const auto with = [&](const std::function<void(json&)>& change) {
    GltfSample changed = sample;
    change(changed.json["animations"][0]);
    return refused(changed);
  };
  EXPECT_SAYS(with([](json& a) { a["channels"][0]["target"]["path"] = "color"; }),
              "/target/path: expected translation, rotation, scale or weights");
  EXPECT_SAYS(with([](json& a) { a["channels"][0]["target"]["path"] = "rotation"; }), "expected \"VEC4\"");
  EXPECT_SAYS(with([](json& a) { a["channels"][0]["sampler"] = 1; }), "there is no such sampler");
  EXPECT_SAYS(with([](json& a) { a["channels"][0]["target"]["node"] = 4; }), "there is no 4 in /nodes");
  EXPECT_SAYS(with([](json& a) { a["samplers"][0]["interpolation"] = "CUBIC"; }),
              "expected LINEAR, STEP or CUBICSPLINE");
  EXPECT_SAYS(with([](json& a) { a["samplers"][0]["interpolation"] = "CUBICSPLINE"; }),
              "its 2 keyframes want 6 values, and there are 2");
  // Times that fall are no fault that could do harm: a keyframe holds until a later one.
  GltfSample falling = square();
  animate(falling, 0, "translation", {1, 1, 0}, {1, 0, 0, 2, 0, 0, 3, 0, 0});
  for (const double t : {0.0, 0.5, 1.0, 2.0}) EXPECT_TRUE(is_finite(at(falling, t).vertices[0]));
}

TEST(GltfAnimation, DamagedFilesAreSafe) {
  GltfSample sample = arm();
  sample.primitive()["targets"] = {{{"POSITION", sample.vectors({0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0})}}};
  animate(sample, 2, "rotation", {0, 1}, turn(0) + turn(90));
  animate(sample, 0, "weights", {0, 1}, {0, 1}, "STEP");
  animate(sample, 1, "translation", {0, 1}, std::vector<float>(18, 1), "CUBICSPLINE");
  const std::string good = sample.text();
  std::mt19937 random(28);
  SCOPED_TRACE("seed 28");
  for (int round = 0; round < 6000; ++round) {
    std::string bad = good;
    for (unsigned i = 0; i <= random() % 3; ++i)
      bad[random() % bad.size()] = "0123456789-+.eE AZaz\"[]{},"[random() % 26];
    try {
      check_scene(read_gltf(bad, "a.gltf", {.time = 0.5}));
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input) << e.what();
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    }
  }
}

// The bounds were computed from the file's numbers by another program. The node is turned upside down, and
// 100 times as large as the mesh.
TEST(GltfAnimation, TheMorphingCubeIsMorphed) {
  const auto file = test::data_path("gltf/AnimatedMorphCube/AnimatedMorphCube.gltf");
  KDRAY_NEED_DATA(file);
  const Scene rest = load(file), moved = load(file, {.time = 1.5});
  expect_near(rest.bounds().lo, {-1, -1, -1}, 1e-5);
  expect_near(rest.bounds().hi, {1, 1, 1}, 1e-5);
  expect_near(moved.bounds().lo, {-1, -1, -1}, 1e-5);
  expect_near(moved.bounds().hi, {1, 1, -0.8719903}, 1e-5);
  EXPECT_TRUE(moved.load_options == (LoadOptions{.time = 1.5}));
}

}  // namespace
}  // namespace kdray::scene
