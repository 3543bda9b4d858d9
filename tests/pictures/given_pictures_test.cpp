// What    Materials with pictures that a program gives, or kdray's JSON, against the same material in a glTF
//         file: the same picture, bit for bit.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "pictures/render.h"
#include "scene/gltf_samples.h"
#include "scene/pictures.h"
#include "scene/scratch.h"

namespace kdray::test {
namespace {

using nlohmann::json;

constexpr int kSide = 24, kTexels = 8;
constexpr unsigned kSeed = 2026;
constexpr float kBase[3] = {0.75f, 0.5f, 0.25f};
constexpr float kMetallic = 0.75f, kRoughness = 0.5f, kOcclusion = 0.5f;

// Three pictures of noise: the base colour's with alpha, metal's, occlusion's.
struct Noise {
  std::vector<std::vector<std::uint8_t>> texels;
  std::vector<int> channels = {4, 3, 3};

  explicit Noise(unsigned seed) {
    std::mt19937 random(seed);
    for (const int n : channels) {
      texels.emplace_back();
      for (int i = 0; i < n * kTexels * kTexels; ++i)
        texels.back().push_back(static_cast<std::uint8_t>(random()));
    }
  }
  std::string file(std::size_t i) const {
    return png(kTexels, kTexels, channels[i], {texels[i].begin(), texels[i].end()});
  }
};

// What the three forms of the scene have in common: the unit square, lit from the side.
struct MaterialCase {
  bool metal, occlusion, base, blend;
};
constexpr MaterialCase kCases[] = {{true, true, true, false},
                                   {true, false, false, false},
                                   {true, true, true, true},
                                   {true, false, true, false}};

Picture rendered(Scene scene) {
  scene.set_background({0.25f, 0.5f, 1});
  scene.set_ambient({0.5f, 0.75f, 1});
  scene.add_light({.kind = Light::Kind::directional, .direction = {0.25, 0.5, -1}});
  scene.set_camera({.from = {0.5, 0.5, 3}, .at = {0.5, 0.5, 0}, .ortho_width = 1.25});
  Renderer renderer(scene, {}, device_of());
  return renderer.render(exact_options(kSide, kSide, 3));
}

Picture from_gltf(const Noise& noise, const MaterialCase& given) {
  GltfSample sample = square();
  for (std::size_t i = 0; i < 3; ++i) {
    sample.json["images"].push_back({{"uri", "data:image/png;base64," + base64(noise.file(i))}});
    sample.json["textures"].push_back({{"source", i}});
  }
  json metal = {{"baseColorFactor", {kBase[0], kBase[1], kBase[2], 1}}};
  if (given.base) metal["baseColorTexture"] = {{"index", 0}};
  if (given.metal) {
    metal["metallicRoughnessTexture"] = {{"index", 1}};
    metal["metallicFactor"] = kMetallic, metal["roughnessFactor"] = kRoughness;
  }
  json material = {{"pbrMetallicRoughness", metal}};
  if (given.occlusion) material["occlusionTexture"] = {{"index", 2}, {"strength", kOcclusion}};
  if (given.blend) material["alphaMode"] = "BLEND";
  sample.json["materials"] = {material};
  sample.primitive()["material"] = 0;
  const int pairs = sample.view(bytes_of<float>({0, 1, 1, 1, 1, 0, 0, 0}));
  sample.primitive()["attributes"]["TEXCOORD_0"] = sample.accessor(pairs, 5126, "VEC2", 4);
  return rendered(Scene::from_memory(sample.text(), "a.gltf"));
}

Picture from_program(const Noise& noise, const MaterialCase& given) {
  Scene scene;
  PictureId ids[3];
  for (std::size_t i = 0; i < 3; ++i)
    ids[i] = scene.add_picture({.data = noise.texels[i].data(),
                                .width = kTexels,
                                .height = kTexels,
                                .channels = static_cast<std::uint32_t>(noise.channels[i])});
  Material m{.diffuse = {kBase[0], kBase[1], kBase[2]}};
  if (given.base) m.picture = ids[0];
  if (given.metal) m.metal_picture = ids[1], m.metallic = kMetallic, m.roughness = kRoughness;
  if (given.occlusion) m.occlusion_picture = ids[2], m.occlusion = kOcclusion;
  if (given.blend) m.alpha = AlphaMode::blend;
  const std::vector<float> corners = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, uv = {0, 1, 1, 1, 1, 0, 0, 0};
  const std::vector<std::uint32_t> faces = {0, 1, 2, 0, 2, 3};
  scene.add_mesh({.vertices = corners, .triangles = faces, .texcoords = {uv.data(), 4}},
                 {.material = scene.add_material(m)});
  return rendered(std::move(scene));
}

Picture from_json(const Noise& noise, const MaterialCase& given, const ScratchFolder& folder) {
  json material = {{"color", {kBase[0], kBase[1], kBase[2]}}};
  const char* const names[] = {"base.png", "metal.png", "occlusion.png"};
  for (std::size_t i = 0; i < 3; ++i) folder.write(names[i], noise.file(i));
  if (given.base) material["picture"] = names[0];
  if (given.metal) material["metal_picture"] = names[1];
  if (given.metal) material["metallic"] = kMetallic, material["roughness"] = kRoughness;
  if (given.occlusion) material["occlusion_picture"] = names[2], material["occlusion"] = kOcclusion;
  if (given.blend) material["alpha"] = "blend";
  const json scene = {{"objects",
                       {{{"type", "triangles"},
                         {"vertices", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}},
                         {"faces", {{0, 1, 2}, {0, 2, 3}}},
                         {"uv", {{0, 1}, {1, 1}, {1, 0}, {0, 0}}},
                         {"material", material}}}}};
  return rendered(Scene::load(folder.write("s.json", scene.dump())));
}

TEST(GivenPictures, OfMetalAndOcclusionAreThoseOfGltf) {
  RecordProperty("seed", kSeed);
  const Noise noise(kSeed);
  const ScratchFolder folder;
  for (const MaterialCase& given : kCases) {
    SCOPED_TRACE(&given - kCases);
    const Picture wanted = from_gltf(noise, given);
    EXPECT_GT(mean_luminance(wanted), 0.05);
    EXPECT_TRUE(same_bits(from_program(noise, given).rgb, wanted.rgb));
    EXPECT_TRUE(same_bits(from_json(noise, given, folder).rgb, wanted.rgb));
  }
}

// Without a picture of metal it takes of the ambient term what it takes where that is given beforehand.
TEST(GivenPictures, OfOcclusionTakeAmbientLight) {
  const auto shown = [](float ambient, std::uint8_t red) {
    Scene scene;
    const std::uint8_t texel[] = {red, 9, 200};
    Material m{.ambient = {ambient, ambient, ambient}};
    if (red != 255) m.occlusion_picture = scene.add_picture({.data = texel, .width = 1, .height = 1});
    const std::vector<float> corners = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, uv = {0, 1, 1, 1, 1, 0, 0, 0};
    const std::vector<std::uint32_t> faces = {0, 1, 2, 0, 2, 3};
    scene.add_mesh({.vertices = corners, .triangles = faces, .texcoords = {uv.data(), 4}},
                   {.material = scene.add_material(m)});
    return rendered(std::move(scene));
  };
  const Picture a = shown(0.5f, 51), b = shown(0.1f, 255);
  for (std::size_t i = 0; i < a.rgb.size(); ++i) ASSERT_NEAR(a.rgb[i], b.rgb[i], 1e-6) << i;
}

}  // namespace
}  // namespace kdray::test
