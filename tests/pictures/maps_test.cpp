// What    glTF's further pictures: of one colour each they are factors, and the picture must be that of the
//         factors; and normals bent by a picture, against the light that the bent plane would have.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "pictures/render.h"
#include "scene/gltf_samples.h"
#include "scene/import/load.h"
#include "scene/pictures.h"

namespace kdray::test {
namespace {

using nlohmann::json;

constexpr int kSide = 32;

// The unit square facing +z, u along x and v down along -y as pictures lie, with materials[0].
template <class Change>
scene::Scene square_with(const json& material, const Change& change,
                         const std::vector<float>& uv = {0, 1, 1, 1, 1, 0, 0, 0}) {
  GltfSample sample = square();
  sample.json["materials"] = {material};
  sample.primitive()["material"] = 0;
  const int pairs = sample.view(bytes_of<float>(uv));
  sample.primitive()["attributes"]["TEXCOORD_0"] = sample.accessor(pairs, 5126, "VEC2", 4);
  change(sample);
  scene::Scene s = scene::read_gltf(sample.text(), "a.gltf");
  EXPECT_EQ(s.warnings, std::vector<std::string>{});
  return s;
}

void add_picture(GltfSample& sample, const std::string& png_bytes) {
  sample.json["images"].push_back({{"uri", "data:image/png;base64," + base64(png_bytes)}});
  sample.json["textures"].push_back({{"source", sample.json["images"].size() - 1}});
}

std::string plain(std::uint16_t r, std::uint16_t g, std::uint16_t b) {
  return png(1, 1, 3, {r, g, b});
}

scene::Scene lit(scene::Scene s, const dvec3& way = {0.3, 0.2, -1}) {
  s.lights = {{.kind = scene::LightKind::directional, .direction = glm::normalize(way), .color = vec3(1)}};
  s.background = {0.2f, 0.5f, 0.9f};
  s.camera = scene::Camera{.from = {0.5, 0.5, 3}, .at = {0.5, 0.5, 0}, .up = {0, 1, 0}, .ortho_width = 0.9};
  return s;
}

Picture rendered(const scene::Scene& model) {
  Renderer renderer(Scene{scene::Scene(model)}, {}, device_of());
  return renderer.render(exact_options(kSide, kSide, 3));
}

void expect_alike(const Picture& a, const Picture& b) {
  ASSERT_EQ(a.rgb.size(), b.rgb.size());
  for (std::size_t i = 0; i < a.rgb.size(); ++i) ASSERT_NEAR(a.rgb[i], b.rgb[i], 2e-5) << i;
}

// The light at the picture's middle.
double middle(const Picture& p) {
  return p.rgb[3 * static_cast<std::size_t>(kSide / 2 * kSide + kSide / 2)];
}

const auto kNothing = [](GltfSample&) {};

// 51 is a fifth of a byte, 153 three fifths.
TEST(Maps, OfMetalAndRoughnessMultiplyTheFactors) {
  for (const double transmission : {0.0, 0.75}) {
    json factors = {
        {"pbrMetallicRoughness",
         {{"baseColorFactor", {0.9, 0.6, 0.3, 1}}, {"metallicFactor", 0.6}, {"roughnessFactor", 0.2}}}};
    factors["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = transmission;
    json mapped = factors;
    mapped["pbrMetallicRoughness"]["metallicFactor"] = 1;
    mapped["pbrMetallicRoughness"]["roughnessFactor"] = 1;
    mapped["pbrMetallicRoughness"]["metallicRoughnessTexture"]["index"] = 0;
    const Picture wanted = rendered(lit(square_with(factors, kNothing)));
    const Picture got =
        rendered(lit(square_with(mapped, [](GltfSample& s) { add_picture(s, plain(7, 51, 153)); })));
    expect_alike(wanted, got);
    EXPECT_GT(mean_luminance(wanted), 0.05);
  }
}

TEST(Maps, OfMetalTakePartWithTheBaseColoursPicture) {
  json factors = {
      {"pbrMetallicRoughness",
       {{"baseColorFactor", {0.6, 0.2, 1, 1}}, {"metallicFactor", 0.2}, {"roughnessFactor", 0.6}}}};
  json mapped = {{"pbrMetallicRoughness",
                  {{"baseColorTexture", {{"index", 0}}},
                   {"baseColorFactor", {0.6, 0.2, 1, 1}},
                   {"metallicRoughnessTexture", {{"index", 1}}}}}};
  const auto pictures = [](GltfSample& s) {
    add_picture(s, plain(255, 255, 255));
    add_picture(s, plain(0, 153, 51));
  };
  expect_alike(rendered(lit(square_with(factors, kNothing))), rendered(lit(square_with(mapped, pictures))));
}

TEST(Maps, OfEmissionShine) {
  json factors = {{"emissiveFactor", {0.5, 0.25, 0}}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}};
  json mapped = factors;
  mapped["emissiveFactor"] = {0.5, 0.5, 0.5};
  mapped["emissiveTexture"]["index"] = 0;
  // 188 is 0.5029 of white in sRGB.
  const scene::Scene s = square_with(mapped, [](GltfSample& f) { add_picture(f, plain(255, 188, 0)); });
  const Picture got = rendered(lit(s)), wanted = rendered(lit(square_with(factors, kNothing)));
  for (std::size_t i = 0; i < got.rgb.size(); ++i) ASSERT_NEAR(got.rgb[i], wanted.rgb[i], 0.002);
}

// Ambient light alone is left where no light is.
TEST(Maps, OfOcclusionTakeAmbientLight) {
  json mapped = {{"occlusionTexture", {{"index", 0}, {"strength", 0.5}}},
                 {"pbrMetallicRoughness", {{"metallicFactor", 0}}}};
  scene::Scene s = square_with(mapped, [](GltfSample& f) { add_picture(f, plain(51, 0, 0)); });
  s = lit(s);
  s.lights[0].color = vec3(0);
  EXPECT_NEAR(middle(rendered(s)), 0.1 * (1 - 0.5 * 0.8), 1e-5);
}

// 191 and 64 are a half and minus a half, nearly: the normal leans over by about 26 degrees.
double light_of(std::uint16_t r, std::uint16_t g, const dvec3& way, const std::vector<float>& uv,
                bool from_behind = false) {
  json material = {{"normalTexture", {{"index", 0}}},
                   {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}};
  scene::Scene s = lit(square_with(
                           material, [&](GltfSample& f) { add_picture(f, plain(r, g, 255)); }, uv),
                       way);
  if (from_behind) s.camera->from.z = -3;
  return middle(rendered(s));
}

double expected_light(const dvec3& normal, const dvec3& way) {
  return 0.1 + std::max(glm::dot(glm::normalize(normal), -glm::normalize(way)), 0.0);
}

TEST(Maps, OfNormalsBendThem) {
  const std::vector<float> upright = {0, 1, 1, 1, 1, 0, 0, 0}, mirrored = {1, 1, 0, 1, 0, 0, 1, 0},
                           turned = {0, 0, 0, 1, 1, 1, 1, 0};  // u goes up, v to the right
  const double bend = 2 * 191 / 255.0 - 1;
  const dvec3 way{0.3, 0.2, -1};
  EXPECT_NEAR(light_of(128, 128, way, upright), expected_light({0, 0, 1}, way), 0.004);
  EXPECT_NEAR(light_of(191, 128, way, upright), expected_light({bend, 0, 1}, way), 0.004);
  EXPECT_NEAR(light_of(128, 191, way, upright), expected_light({0, bend, 1}, way), 0.004);
  EXPECT_NEAR(light_of(191, 128, way, mirrored), expected_light({-bend, 0, 1}, way), 0.004);
  EXPECT_NEAR(light_of(128, 191, way, mirrored), expected_light({0, bend, 1}, way), 0.004);
  // What is to the right in the picture is up in the world; what is up in the picture is to the left.
  EXPECT_NEAR(light_of(191, 128, way, turned), expected_light({0, bend, 1}, way), 0.004);
  EXPECT_NEAR(light_of(128, 191, way, turned), expected_light({-bend, 0, 1}, way), 0.004);
}

TEST(Maps, OfNormalsAreTurnedRoundBehind) {
  const std::vector<float> upright = {0, 1, 1, 1, 1, 0, 0, 0};
  const double bend = 2 * 191 / 255.0 - 1;
  const dvec3 way{0.3, 0.2, 1};  // from behind
  EXPECT_NEAR(light_of(191, 128, way, upright, true), expected_light({-bend, 0, -1}, way), 0.004);
}

// A light below the surface stays there, however the normal leans.
TEST(Maps, OfNormalsLetNoLightThrough) {
  const std::vector<float> upright = {0, 1, 1, 1, 1, 0, 0, 0};
  EXPECT_NEAR(light_of(255, 128, {-1, 0, 0.05}, upright), 0.1, 1e-5);
}

// Without coordinates that tell a direction the normal stays.
TEST(Maps, OfNormalsNeedADirection) {
  const dvec3 way{0.3, 0.2, -1};
  EXPECT_NEAR(light_of(191, 191, way, {0, 0, 0, 0, 0, 0, 0, 0}), expected_light({0, 0, 1}, way), 1e-5);
}

}  // namespace
}  // namespace kdray::test
