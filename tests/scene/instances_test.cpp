// What    Instances as files have them: what importers keep and what they copy, with what transforms, and
//         what they refuse. Copies are what the file always was.
#include "scene/model/instances.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "scene/gltf_samples.h"
#include "scene/import/load.h"
#include "scene/model/check_scene.h"
#include "scene/scratch.h"

namespace kdray::scene {
namespace {

using test::bytes_of;
using test::GltfSample;
using test::refusal;
using test::ScratchFolder;
using test::square;

Scene read(const GltfSample& sample, Instances how) {
  const Instancing as(how);
  Scene scene = read_gltf(sample.text(), "a.gltf");
  check_scene(scene);
  return scene;
}

// Two nodes below a third, each with the square.
GltfSample pair_of_squares() {
  GltfSample sample = square();
  sample.json["nodes"] = {
      {{"children", {1, 2}}, {"translation", {0, 0, 5}}},
      {{"mesh", 0}, {"scale", {2, 2, 2}}},
      {{"mesh", 0}, {"scale", {-1, 1, 1}}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}}};
  return sample;
}

TEST(InstancesOfGltf, AreNodesThatShareAMesh) {
  const Scene s = read(pair_of_squares(), Instances::kept);
  ASSERT_EQ(s.meshes.size(), 1u);
  ASSERT_EQ(s.instances.size(), 2u);
  EXPECT_TRUE(s.triangles.empty());
  EXPECT_EQ(s.meshes[0]->triangles.size(), 2u);
  EXPECT_EQ(s.meshes[0]->triangles[1].number, 1u);
  EXPECT_EQ(s.instances[0].point({1, 1, 0}), dvec3(2, 2, 5));
  EXPECT_LT(glm::length(s.instances[1].point({1, 0, 0}) - dvec3(0, -1, 5)), 1e-12);
  EXPECT_EQ(s.bounds().hi, dvec3(2, 2, 5));
}

TEST(InstancesOfGltf, AreCopiedWhereTheyAreSmall) {
  const Scene automatic = read(pair_of_squares(), Instances::automatic),
              flat = read(pair_of_squares(), Instances::flat);
  EXPECT_TRUE(automatic.instances.empty() && automatic.meshes.empty());
  EXPECT_EQ(automatic.triangles.size(), 4u);
  EXPECT_EQ(automatic.vertices, flat.vertices);
}

// What flattening makes of them is what the importer makes by copying.
TEST(InstancesOfGltf, FlattenedAreTheCopies) {
  Scene kept = read(pair_of_squares(), Instances::kept);
  const Scene copied = read(pair_of_squares(), Instances::flat);
  flatten_instances(kept);
  check_scene(kept);
  ASSERT_EQ(kept.triangles.size(), copied.triangles.size());
  for (std::size_t i = 0; i < kept.triangles.size(); ++i) {
    EXPECT_EQ(kept.triangles[i].number, copied.triangles[i].number);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LT(glm::length(kept.vertices[kept.triangles[i].vertex[k]] -
                            copied.vertices[copied.triangles[i].vertex[k]]),
                1e-12);
  }
}

TEST(InstancesOfGltf, AreThoseOfGpuInstancing) {
  GltfSample sample = square();
  auto& attributes = sample.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes["TRANSLATION"] = sample.vectors({0, 0, 0, 3, 0, 0, 0, 4, 0});
  attributes["SCALE"] = sample.vectors({1, 1, 1, 2, 2, 2, 1, 1, -1});
  const float r = std::sqrt(0.5f);
  attributes["ROTATION"] =
      sample.accessor(sample.view(bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, r, 0, r})), 5126, "VEC4", 3);
  sample.json["nodes"][0]["translation"] = {10, 0, 0};
  sample.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const Scene s = read(sample, Instances::kept);
  ASSERT_EQ(s.instances.size(), 3u);
  EXPECT_EQ(s.instances[0].point({1, 1, 0}), dvec3(11, 1, 0));
  EXPECT_EQ(s.instances[1].point({1, 1, 0}), dvec3(15, 2, 0));
  EXPECT_LT(glm::length(s.instances[2].point({1, 1, 0}) - dvec3(10, 5, -1)), 1e-6);
  EXPECT_EQ(read(sample, Instances::automatic).triangles.size(), 6u);

  attributes["SCALE"] = sample.vectors({1, 1, 1});
  EXPECT_NE(refusal([&] { read(sample, Instances::kept); }).find("not equally many"), std::string::npos);
  attributes.erase("SCALE");
  attributes["ROTATION"] = attributes["TRANSLATION"];
  EXPECT_NE(refusal([&] { read(sample, Instances::kept); }).find("VEC4"), std::string::npos);
}

// A flat transform has no inverse, so what it makes is copied.
TEST(InstancesOfGltf, OfFlatTransformsAreCopied) {
  GltfSample sample = pair_of_squares();
  sample.json["nodes"][1]["scale"] = {1, 1, 0};
  const Scene s = read(sample, Instances::kept);
  EXPECT_EQ(s.instances.size(), 1u);
  EXPECT_EQ(s.triangles.size(), 2u);
}

TEST(InstancesOfGltf, PayWhereCopiesAreMany) {
  EXPECT_FALSE(worth_keeping(1000, 1000));
  EXPECT_TRUE(worth_keeping(100000, 1000));
  EXPECT_FALSE(worth_keeping(100000000, 1));
  EXPECT_FALSE(worth_keeping(0, 1000000));
}

std::string json_with(const std::string& instances) {
  return R"({"materials": {"red": {"color": [1, 0, 0]}},
             "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1},
                         {"type": "mesh", "file": "square.gltf", "scale": 2, "instances": )" +
         instances + "}]}";
}

class InstancesOfJson : public testing::Test {
 protected:
  Scene read(const std::string& instances, Instances how) const {
    const Instancing as(how);
    Scene scene = read_json(json_with(instances), folder_ / "s.json");
    check_scene(scene);
    return scene;
  }
  std::string refused(const std::string& instances) const {
    return refusal([&] { read(instances, Instances::kept); });
  }

  ScratchFolder folder_;
  std::filesystem::path mesh_ = folder_.write("square.gltf", square().text());
};

TEST_F(InstancesOfJson, ArePlacedAfterTheMesh) {
  const std::string places =
      R"([{"translate": [5, 0, 0]}, {"scale": -1, "material": "red"}, {},
          {"matrix": [1,0,0,7, 0,1,0,0, 0,0,1,0, 0,0,0,1]}])";
  const Scene s = read(places, Instances::kept);
  ASSERT_EQ(s.instances.size(), 4u);
  ASSERT_EQ(s.meshes.size(), 1u);
  EXPECT_EQ(s.meshes[0]->vertices[2], dvec3(2, 2, 0));
  EXPECT_EQ(s.instances[0].point({2, 2, 0}), dvec3(7, 2, 0));
  EXPECT_EQ(s.instances[1].point({2, 2, 0}), dvec3(-2, -2, 0));
  EXPECT_EQ(s.materials[s.instances[1].material].diffuse, vec3(0.9f, 0, 0));
  EXPECT_EQ(s.instances[0].material, kNone);
  EXPECT_EQ(s.instances[3].move, dvec3(7, 0, 0));
  const Scene copied = read(places, Instances::automatic);
  EXPECT_EQ(copied.triangles.size(), 8u);
  EXPECT_EQ(copied.triangles[7].number, 8u);  // the sphere is 0
  EXPECT_EQ(copied.materials[copied.triangles[2].material].diffuse, vec3(0.9f, 0, 0));
  EXPECT_TRUE(copied.instances.empty());
}

TEST_F(InstancesOfJson, MayBeNone) {
  const Scene s = read("[]", Instances::kept);
  EXPECT_TRUE(s.instances.empty() && s.meshes.empty() && s.triangles.empty());
}

TEST_F(InstancesOfJson, AreRefusedInOneLine) {
  EXPECT_NE(refused("3").find("/objects/1/instances"), std::string::npos);
  EXPECT_NE(refused(R"([{"scale": 0}])").find("a scale of 0"), std::string::npos);
  EXPECT_NE(
      refused(R"([{}, {"scale": [1, 1, 1e-30]}])").find("/objects/1/instances/1: a transform that flattens"),
      std::string::npos);
  EXPECT_NE(refused(R"([{"scale": [1, 1, 1000]}])").find("stretches"), std::string::npos);
  EXPECT_NE(refused(R"([{"move": [1, 0, 0]}])").find("unknown key"), std::string::npos);
  EXPECT_NE(refused(R"([{"material": "blue"}])").find("no material 'blue'"), std::string::npos);
}

// Programs have their rotations in floats, files to six digits.
TEST(CopiesOfShapes, MayBeTurnedByRoundedRotations) {
  Scene s;
  s.spheres.push_back({.center = {1, 2, 3}, .radius = 2});
  s.cones.push_back({.base = {0, 0, 0}, .apex = {0, 0, 4}, .base_radius = 1, .apex_radius = 0.5});
  dmat4 turn = translation({5, 0, 0}) * rotation(glm::normalize(dvec3(1, 2, -3)), 0.7) * scaling(dvec3(3));
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) turn[column][row] = std::round(turn[column][row] * 1e6) * 1e-6;
  apply_transform(turn, s);
  EXPECT_LT(glm::length(s.spheres[0].center - dvec3(turn * glm::dvec4(1, 2, 3, 1))), 1e-12);
  EXPECT_NEAR(s.spheres[0].radius, 6, 1e-5);
  EXPECT_NEAR(s.cones[0].apex_radius, 1.5, 1e-5);
  turn[0][0] += 1e-4;
  EXPECT_THROW(apply_transform(turn, s), std::domain_error);
}

}  // namespace
}  // namespace kdray::scene
