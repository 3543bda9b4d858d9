#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "scene/gltf_samples.h"
#include "scene/import/load.h"
#include "scene/model/check_scene.h"
#include "scene/scratch.h"

namespace kdray::scene {
namespace {

using nlohmann::json;

Material material_of(const json& material) {
  test::GltfSample sample = test::square();
  sample.json["materials"] = {material};
  sample.primitive()["material"] = 0;
  Scene s = read_gltf(sample.text(), "a.gltf");
  check_scene(s);
  return s.materials.at(s.triangles.at(0).material);
}

json pbr(const json& factors) {
  return {{"pbrMetallicRoughness", factors}};
}

float largest(const vec3& v) {
  return std::max({v.x, v.y, v.z});
}

void expect_near(const vec3& a, const vec3& b) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-5) << i;
}

std::vector<std::string> warnings_of(const json& material) {
  test::GltfSample sample = test::square();
  sample.json["materials"] = {material};
  sample.primitive()["material"] = 0;
  return read_gltf(sample.text(), "a.gltf").warnings;
}

TEST(GltfMaterial, SaysWhatIsLeftOut) {
  json material = {{"alphaMode", "MASK"}};
  material["extensions"]["KHR_materials_clearcoat"]["clearcoatFactor"] = 1;
  material["extensions"]["KHR_materials_sheen"]["sheenColorFactor"] = {1, 1, 1};
  material["extensions"]["KHR_materials_iridescence"]["iridescenceFactor"] = 0;
  EXPECT_EQ(warnings_of(material),
            (std::vector<std::string>{"a.gltf: KHR_materials_clearcoat of 1 material is left out",
                                      "a.gltf: KHR_materials_sheen of 1 material is left out"}));
  for (const char* name : {"specular", "anisotropy"}) {
    json other;
    other["extensions"][std::string("KHR_materials_") + name]["anisotropyStrength"] = 0.5;
    ASSERT_EQ(warnings_of(other).size(), 1u) << name;
    EXPECT_NE(warnings_of(other)[0].find(name), std::string::npos);
  }
}

TEST(GltfMaterial, DefaultsToAMattGrey) {
  const Material m = material_of(json::object());
  expect_near(m.diffuse, vec3(1));
  expect_near(m.ambient, vec3(0.1f));
  EXPECT_EQ(m.reflect, vec3(0));
  EXPECT_EQ(m.transmit, vec3(0));
  EXPECT_EQ(m.specular, vec3(0));
}

TEST(GltfMaterial, MetalIsAMirrorOfItsColour) {
  const json base = {0.9, 0.5, 0.1, 1};
  const Material smooth = material_of(pbr({{"baseColorFactor", base}, {"roughnessFactor", 0}}));
  expect_near(smooth.reflect, vec3(0.9f, 0.5f, 0.1f));
  expect_near(smooth.diffuse, vec3(0));
  const Material rough = material_of(pbr({{"baseColorFactor", base}, {"roughnessFactor", 0.75}}));
  expect_near(rough.reflect, 0.25f * vec3(0.9f, 0.5f, 0.1f));
  expect_near(rough.diffuse, 0.75f * vec3(0.9f, 0.5f, 0.1f));
  EXPECT_LT(rough.shine, smooth.shine);
}

TEST(GltfMaterial, PlasticHasAHighlightAndNoMirror) {
  const Material m = material_of(
      pbr({{"baseColorFactor", {0.2, 0.4, 0.6, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 0.5}}));
  expect_near(m.diffuse, vec3(0.2f, 0.4f, 0.6f));
  EXPECT_EQ(m.reflect, vec3(0));
  EXPECT_GT(m.specular.x, 0);
  EXPECT_NEAR(m.shine, (2 / 0.0625 - 2) / 4, 1e-4);  // alpha = 0.5^2
}

TEST(GltfMaterial, GlassRefractsWhenItIsABody) {
  json glass = pbr({{"metallicFactor", 0}, {"roughnessFactor", 0}});
  glass["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = 1;
  const Material sheet = material_of(glass);
  EXPECT_EQ(sheet.index, 1);
  EXPECT_GT(sheet.transmit.x, 0.9f);
  EXPECT_GT(sheet.reflect.x, 0.05f);
  EXPECT_EQ(sheet.diffuse, vec3(0));
  glass["extensions"]["KHR_materials_volume"]["thicknessFactor"] = 1;
  EXPECT_EQ(material_of(glass).index, 1.5f);
  glass["extensions"]["KHR_materials_ior"]["ior"] = 1.33;
  EXPECT_EQ(material_of(glass).index, 1.33f);
}

TEST(GltfMaterial, BlendingIsAVeil) {
  json veil = pbr({{"baseColorFactor", {1, 0, 0, 0.25}}, {"metallicFactor", 0}});
  EXPECT_EQ(material_of(veil).transmit, vec3(0));  // opaque unless it says BLEND
  veil["alphaMode"] = "BLEND";
  const Material m = material_of(veil);
  expect_near(m.transmit, vec3(0.75f));
  expect_near(m.diffuse, vec3(0.25f, 0, 0));
  EXPECT_EQ(m.index, 1);
}

TEST(GltfMaterial, Glows) {
  json lamp = {{"emissiveFactor", {1, 0.5, 0}}};
  lamp["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 4;
  EXPECT_EQ(material_of(lamp).emission, vec3(4, 2, 0));
  lamp["emissiveTexture"]["index"] = 0;
  EXPECT_EQ(material_of(lamp).emission, vec3(0));
  json unlit = pbr({{"baseColorFactor", {0.5, 0.25, 0, 1}}});
  unlit["extensions"]["KHR_materials_unlit"] = json::object();
  const Material m = material_of(unlit);
  EXPECT_EQ(m.emission, vec3(0.5f, 0.25f, 0));
  EXPECT_EQ(m.diffuse, vec3(0));
}

TEST(GltfMaterial, ReadsTheOlderGlossyModel) {
  json glossy = json::object();
  glossy["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {
      {"diffuseFactor", {0.1, 0.2, 0.3, 1}}, {"specularFactor", {1, 0, 0}}, {"glossinessFactor", 0.5}};
  const Material m = material_of(glossy);
  expect_near(m.diffuse, vec3(0.1f, 0.2f, 0.3f));
  expect_near(m.specular, vec3(0.5f, 0, 0));
}

// The file has neither of them.
TEST(GltfMaterial, IsPlainWherePicturesWouldSpeak) {
  json helmet = pbr({{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 1}}}});
  const Material m = material_of(helmet);
  expect_near(m.diffuse, vec3(1));
  EXPECT_EQ(m.reflect, vec3(0));
  EXPECT_GT(m.specular.x, 0);
}

TEST(GltfMaterial, NeverSendsOnMoreLightThanItGets) {
  for (const double metallic : {0.0, 0.3, 1.0}) {
    for (const double roughness : {0.0, 0.5, 1.0}) {
      for (const double transmission : {0.0, 0.5, 1.0}) {
        for (const double alpha : {0.0, 0.6, 1.0}) {
          json m = pbr({{"baseColorFactor", {1, 1, 1, alpha}},
                        {"metallicFactor", metallic},
                        {"roughnessFactor", roughness}});
          m["alphaMode"] = "BLEND";
          m["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = transmission;
          const Material w = material_of(m);
          EXPECT_LE(largest(w.diffuse + w.reflect + w.transmit), 1.0001f) << m;
        }
      }
    }
  }
}

TEST(GltfMaterial, RefusesWrongTypes) {
  const auto refused = [](const json& m) { return test::refusal([&] { material_of(m); }); };
  const auto says = [&](const json& m, const std::string& part) {
    const std::string message = refused(m);
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  says({{"pbrMetallicRoughness", 3}}, "/materials/0/pbrMetallicRoughness: expected an object, found 3");
  says(pbr({{"baseColorFactor", {1, 1}}}),
       "/materials/0/pbrMetallicRoughness/baseColorFactor: expected [red, green, blue]");
  says(pbr({{"metallicFactor", "x"}}), "metallicFactor: expected a number");
}

}  // namespace
}  // namespace kdray::scene
