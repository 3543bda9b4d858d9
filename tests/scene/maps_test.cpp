// What    What files and programs say of further pictures: glTF's and MTL's maps, pictures of kdray's JSON
//         and of a program's own, and the limit of their bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "scene/gltf_samples.h"
#include "scene/import/load.h"
#include "scene/model/added_geometry.h"
#include "scene/model/check_scene.h"
#include "scene/pictures.h"
#include "scene/scratch.h"
#include "scene/textures/mipmaps.h"
#include "scene/textures/picture.h"

namespace kdray::scene {
namespace {

using nlohmann::json;

#define EXPECT_SAYS(message, part) EXPECT_NE(std::string(message).find(part), std::string::npos) << (message)

Scene checked(Scene s) {
  check_scene(s);
  return s;
}

const MaterialMaps& maps_of(const Scene& s, std::size_t triangle) {
  return s.texturing.material_maps.at(s.materials.at(s.triangles.at(triangle).material).maps);
}

template <class Change>
Scene gltf_with(const json& material, const Change& change) {
  test::GltfSample sample = test::square();
  json& j = sample.json;
  j["images"] = {{{"uri", "data:image/png;base64," + test::base64(test::four_colors())}}};
  j["textures"] = {{{"source", 0}}};
  j["materials"] = {material};
  sample.primitive()["material"] = 0;
  const int pairs = sample.view(test::bytes_of<float>({0, 0, 1, 0, 1, 1, 0, 1}));
  sample.primitive()["attributes"]["TEXCOORD_0"] = sample.accessor(pairs, 5126, "VEC2", 4);
  change(sample);
  return checked(read_gltf(sample.text(), "a.gltf"));
}
const auto kNothing = [](test::GltfSample&) {};

const json kAllMaps = {{"normalTexture", {{"index", 0}, {"scale", 0.5}}},
                       {"occlusionTexture", {{"index", 0}, {"strength", 0.25}}},
                       {"emissiveTexture", {{"index", 0}}},
                       {"emissiveFactor", {1, 0.5, 0.25}},
                       {"pbrMetallicRoughness",
                        {{"metallicRoughnessTexture", {{"index", 0}}},
                         {"baseColorFactor", {0.5, 1, 1, 1}},
                         {"roughnessFactor", 0.75}}}};

TEST(Maps, OfGltf) {
  const Scene s = gltf_with(kAllMaps, kNothing);
  EXPECT_EQ(s.warnings, std::vector<std::string>{});
  const MaterialMaps& c = maps_of(s, 0);
  EXPECT_EQ(c.base, kNone);
  EXPECT_EQ(c.normal_scale, 0.5f);
  EXPECT_EQ(c.occlusion, 0.25f);
  EXPECT_EQ(c.emissive, vec3(1, 0.5f, 0.25f));
  EXPECT_EQ(c.metal.base, vec3(0.5f, 1, 1));
  EXPECT_EQ(c.metal.metallic, 1);
  EXPECT_EQ(c.metal.roughness, 0.75f);
  for (const std::uint32_t linear : {c.normal_map, c.occlusion_map, c.metal_map})
    EXPECT_FALSE(s.texturing.textures.at(linear).curved);
  EXPECT_TRUE(s.texturing.textures.at(c.emission_map).curved);
  EXPECT_EQ(s.texturing.pictures.size(), 1u);
  EXPECT_EQ(s.texturing.textures.size(), 2u);
  EXPECT_EQ(s.materials[0].emission, vec3(0));
  EXPECT_EQ(s.materials[0].diffuse, vec3(0));
}

TEST(Maps, OfGltfThatCantBeReadAreLeftOutAndTold) {
  const Scene s = gltf_with(kAllMaps, [](test::GltfSample& f) { f.json["images"][0]["uri"] = "gone.png"; });
  EXPECT_EQ(s.warnings.size(), 1u);
  EXPECT_TRUE(s.texturing.material_maps.empty());
  EXPECT_EQ(s.materials[0].emission, vec3(0));
  EXPECT_EQ(s.materials[0].reflect, vec3(0));  // no mirror, though its factor says metal
}

TEST(Maps, OfGltfSamplersMinify) {
  const auto minify = [](int filter) {
    const Scene s = gltf_with(kAllMaps, [&](test::GltfSample& f) {
      f.json["samplers"] = {{{"minFilter", filter}}};
      f.json["textures"][0]["sampler"] = 0;
    });
    return s.texturing.textures.empty() ? Minify::as_magnified : s.texturing.textures[0].minify;
  };
  EXPECT_EQ(minify(9728), Minify::nearest);
  EXPECT_EQ(minify(9729), Minify::linear);
  EXPECT_EQ(minify(9984), Minify::nearest_mipmap_nearest);
  EXPECT_EQ(minify(9985), Minify::linear_mipmap_nearest);
  EXPECT_EQ(minify(9986), Minify::nearest_mipmap_linear);
  EXPECT_EQ(minify(9987), Minify::linear_mipmap_linear);
  EXPECT_EQ(minify(9983), Minify::as_magnified);  // refused, so there is no texture
}

Scene obj_with(const test::ScratchFolder& folder, const std::string& mtl) {
  folder.write("a.mtl", "newmtl m\n" + mtl);
  return checked(import_scene(
      folder.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n")));
}

TEST(Maps, OfMtl) {
  const test::ScratchFolder folder;
  folder.write("p.png", test::four_colors());
  const Scene s =
      obj_with(folder, "Kd 1 1 1\nKs 0.5 0.5 0.5\nNs 20\nKe 0 0 0\nmap_Ke p.png\nmap_Ks p.png\nnorm p.png\n");
  EXPECT_EQ(s.warnings, std::vector<std::string>{});
  const MaterialMaps& c = maps_of(s, 0);
  EXPECT_EQ(c.base, kNone);
  EXPECT_EQ(c.emissive, vec3(1));
  EXPECT_EQ(c.specular, vec3(0.5f));
  EXPECT_EQ(s.materials[0].specular, vec3(0));
  EXPECT_EQ(s.materials[0].shine, 20);
  EXPECT_NE(c.highlight_map, kNone);
  EXPECT_FALSE(s.texturing.textures.at(c.normal_map).curved);
}

TEST(Maps, OfMtlReliefsBecomeNormals) {
  const test::ScratchFolder folder;
  folder.write("h.png", test::png(4, 1, 1, {0, 0, 255, 255}));
  const Scene s = obj_with(folder, "map_Bump -bm 2 h.png\n");
  const Picture& normals =
      *s.texturing.pictures.at(s.texturing.textures.at(maps_of(s, 0).normal_map).picture);
  // From the second texel to the fourth it rises by 1, of which half counts for one texel: a slope of 1.
  const double lean = std::sqrt(0.5);
  EXPECT_NEAR(normals.texels[4 * 1 + 0], (1 - lean) / 2 * 255, 0.6);
  EXPECT_NEAR(normals.texels[4 * 1 + 2], (1 + lean) / 2 * 255, 0.6);
  EXPECT_NEAR(normals.texels[4 * 1 + 1], 127.5, 0.6);
}

TEST(Maps, OfMtlDissolveAreHolesOrVeils) {
  const test::ScratchFolder folder;
  folder.write("p.png", test::four_colors());
  folder.write("cut.png", test::png(2, 1, 1, {0, 255}));
  folder.write("half.png", test::png(1, 1, 1, {127}));
  const Scene cut = obj_with(folder, "map_Kd p.png\nmap_d cut.png\n");
  EXPECT_EQ(maps_of(cut, 0).mode, Alpha::mask);
  const Picture& shown = *cut.texturing.pictures.at(cut.texturing.textures.at(maps_of(cut, 0).base).picture);
  EXPECT_EQ(shown.texels[0], 255);  // red, cut out
  EXPECT_EQ(shown.texels[3], 0);
  EXPECT_EQ(shown.texels[7], 255);
  const Scene veil = obj_with(folder, "map_d half.png\n");
  EXPECT_EQ(maps_of(veil, 0).mode, Alpha::blend);
}

// A scene of kdray's own with a picture on a square.
std::string json_scene(const std::string& material) {
  return R"({"objects": [{"type": "triangles", "vertices": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]],
    "faces": [[0,1,2,3]], "uv": [[0,1],[1,1],[1,0],[0,0]], "material": )" +
         material + "}]}";
}

TEST(Maps, OfJson) {
  const test::ScratchFolder folder;
  folder.write("p.png", test::four_colors());
  const auto file = folder.write("s.json", json_scene(R"({"color": 0.5, "picture": "p.png",
      "normal_picture": "p.png", "emission_picture": "p.png", "alpha": "mask"})"));
  const Scene s = checked(import_scene(file));
  EXPECT_EQ(s.warnings, std::vector<std::string>{});
  const MaterialMaps& c = maps_of(s, 1);
  EXPECT_EQ(c.diffuse, vec3(0.45f));
  EXPECT_EQ(c.mode, Alpha::mask);
  EXPECT_EQ(c.emissive, vec3(1));
  EXPECT_EQ(s.texturing.pictures.size(), 1u);
  EXPECT_EQ(s.texturing.textures.size(), 2u);  // as colours and as normals
  ASSERT_EQ(s.texturing.texcoords[0].size(), 2u);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const dvec3& at = s.vertices[s.triangles[i].vertex[k]];
      EXPECT_EQ(s.texturing.texcoords[0][i].uv[k][0], at.x);
      EXPECT_EQ(s.texturing.texcoords[0][i].uv[k][1], 1 - at.y);
    }
}

TEST(Maps, OfJsonAreRefusedWithThePath) {
  const test::ScratchFolder folder;
  folder.write("bad.png", "\x89PNG no picture");
  const auto refusal = [&](const std::string& text) -> std::string {
    try {
      import_scene(folder.write("s.json", text));
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input);
      const std::string what = e.what();
      EXPECT_EQ(what.find('\n'), std::string::npos);
      return what;
    }
    return "nothing";
  };
  EXPECT_SAYS(refusal(json_scene(R"({"picture": "gone.png"})")), "/objects/0/material/picture");
  EXPECT_SAYS(refusal(json_scene(R"({"picture": "bad.png"})")), "/objects/0/material/picture");
  EXPECT_SAYS(refusal(json_scene(R"({"alpha": "mask"})")), "there is no picture whose alpha");
  EXPECT_SAYS(refusal(json_scene(R"({"roughness": 0.5})")), "/objects/0/material/roughness");
  EXPECT_SAYS(refusal(json_scene(R"({"metal_picture": "gone.png"})")), "/objects/0/material/metal_picture");
  EXPECT_SAYS(refusal(R"({"objects": [{"type": "triangles", "vertices": [[0,0,0],[1,0,0],[1,1,0]],
      "faces": [[0,1,2]], "uv": [[0,1]]}]})"),
              "not one pair for each vertex");
  EXPECT_SAYS(refusal(R"({"objects": [{"type": "triangles", "vertices": [[0,0,0],[1,0,0],[1,1,0]],
      "faces": [[0,1,2]], "uv": [[0,1],[0,1],[0,1e300]]}]})"),
              "beyond 3.4e38");
}

TEST(Maps, OfJsonOnAMeshFile) {
  const test::ScratchFolder folder;
  folder.write("p.png", test::four_colors());
  folder.write("a.mtl", "newmtl m\nmap_Kd p.png\n");
  folder.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 1\nvt 1 0\nusemtl m\nf 1/1 2/2 3/2\n");
  folder.write("b.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  const auto file = folder.write("s.json", R"({"materials": {"m": {"picture": "p.png"}}, "objects": [
      {"type": "sphere", "center": [0,0,0], "radius": 1, "material": "m"},
      {"type": "mesh", "file": "a.obj", "material": "m"},
      {"type": "mesh", "file": "b.obj", "material": "m"}]})");
  const Scene s = checked(import_scene(file));
  EXPECT_EQ(maps_of(s, 0).base, maps_of(s, 1).base);
  EXPECT_EQ(s.texturing.texcoords[0].at(0).uv[1][0], 1);
  ASSERT_EQ(s.warnings.size(), 2u);
  EXPECT_SAYS(s.warnings[0], "/objects/0: shapes show one place");
  EXPECT_SAYS(s.warnings[1], "has no texture coordinates");
}

TEST(Maps, OfAProgram) {
  const std::uint8_t grey[] = {0, 255, 7, 7};  // two rows of two
  const auto picture =
      picture_of(Pixels{.data = grey, .width = 2, .height = 1, .channels = 2, .row_bytes = 4});
  EXPECT_EQ(test::bytes_of(*picture), (std::vector<std::uint8_t>{0, 0, 0, 255, 7, 7, 7, 7}));
  Texturing texturing;
  texturing.pictures = {picture};
  kdray::Material m{.diffuse = {0.5f, 0.5f, 0.5f}, .picture = 0, .alpha = AlphaMode::blend};
  const Material mapped = textured_material(m, texturing);
  const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::uint32_t triangles[] = {0, 1, 2};
  const float uv[] = {0, 0, 1, 0, 0, 1};
  const AddedGeometry mesh = make_added(Mesh{{corners, 3}, {triangles, 1}, {}, {uv, 3}});
  const AddedGeometry bare = make_added(Mesh{{corners, 3}, {triangles, 1}});
  const std::vector<const AddedGeometry*> geometries{&bare, &mesh};
  Scene s = gltf_with(kAllMaps, kNothing);
  const std::size_t n_maps = s.texturing.material_maps.size();
  assemble(s, geometries, std::vector{mapped});
  assemble_textures(s, geometries, texturing, 1);
  check_scene(s);
  EXPECT_EQ(s.texturing.material_maps.size(), n_maps + 1);
  EXPECT_EQ(maps_of(s, 3).mode, Alpha::blend);
  EXPECT_EQ(maps_of(s, 3).diffuse, vec3(0.5f));
  ASSERT_EQ(s.texturing.texcoords[0].size(), 4u);
  EXPECT_EQ(s.texturing.texcoords[0][3].uv[1][0], 1);
  EXPECT_EQ(s.texturing.texcoords[0][2].uv[1][0], 0);
}

TEST(Maps, OfAProgramAreRefused) {
  const std::uint8_t byte = 0;
  const auto refuses = [](const auto& work, const char* part) {
    try {
      work();
      ADD_FAILURE() << part;
    } catch (const Error& e) {
      EXPECT_SAYS(e.what(), part);
    }
  };
  refuses([&] { picture_of(Pixels{&byte, 1, 1, 5}); }, "5 channels");
  refuses([&] { picture_of(Pixels{&byte, 0, 1, 1}); }, "no pixels");
  refuses([&] { picture_of(Pixels{&byte, 1u << 20, 1u << 20, 1}); }, "textures have");
  refuses([&] { picture_of(Pixels{nullptr, 1, 1, 1}); }, "no data");
  refuses([&] { picture_of(Pixels{&byte, 1, 2, 1, static_cast<std::size_t>(-1)}); }, "beyond any memory");
  Texturing texturing;
  refuses([&] { textured_material({.picture = 3}, texturing); }, "picture: there is no such picture");
  refuses([&] { textured_material({.alpha = AlphaMode::mask}, texturing); }, "no picture whose alpha");
  refuses([&] { textured_material({.metal_picture = 3}, texturing); },
          "metal_picture: there is no such picture");
  refuses([&] { textured_material({.metallic = 1.5f}, texturing); }, "metallic may be 0 to 1");
  refuses([&] { textured_material({.roughness = NAN}, texturing); }, "roughness may be 0 to 1");
  refuses([&] { textured_material({.occlusion = -1}, texturing); }, "occlusion may be 0 to 1");
  const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::uint32_t triangles[] = {0, 1, 2};
  const float uv[] = {0, 0, 1, 0, 0, NAN};
  refuses([&] { make_added(Mesh{{corners, 3}, {triangles, 1}, {}, {uv, 2}}); }, "texcoords: 2 of them");
  refuses([&] { make_added(Mesh{{corners, 3}, {triangles, 1}, {}, {uv, 3}}); }, "texcoords[2]: not finite");
}

std::shared_ptr<const Picture> even(std::uint32_t width, std::uint32_t height, std::uint8_t value) {
  Picture picture = blank_picture("even", width, height);
  std::fill(picture.texels.begin(), picture.texels.end(), value);
  return std::make_shared<const Picture>(std::move(picture));
}

TEST(PictureLimit, HalvesTheLargestUntilAllFit) {
  Texturing texturing;
  texturing.pictures = {even(64, 64, 9), even(16, 16, 200), even(128, 128, 1)};
  texturing.add(Texture{.picture = 0, .minify = Minify::linear_mipmap_linear});
  texturing.add(Texture{.picture = 1});  // the third isn't shown
  const std::uint64_t with = 4 * (64 * 64 + 32 * 32 + 16 * 16 + 64 + 16 + 4 + 1);
  EXPECT_EQ(picture_bytes(texturing), with + 4 * 256);
  EXPECT_EQ(limit_pictures(texturing, picture_bytes(texturing)).n_halved, 0u);
  const LimitedPictures limited = limit_pictures(texturing, 7000);
  EXPECT_EQ(limited.n_halved, 1u);
  EXPECT_EQ(limited.bytes_before, with + 1024);
  EXPECT_EQ(limited.bytes, with - 4 * 64 * 64 + 1024);
  EXPECT_EQ(limited.bytes, picture_bytes(texturing));
  EXPECT_EQ(texturing.pictures[0]->width, 32u);
  EXPECT_EQ(test::bytes_of(*texturing.pictures[0]), std::vector<std::uint8_t>(32 * 32 * 4, 9));
  EXPECT_EQ(texturing.pictures[1]->width, 16u);
  EXPECT_EQ(limit_pictures(texturing, 0).bytes, 8u);  // a texel each is the least
}

TEST(PictureLimit, IsToldInOneLine) {
  const test::ScratchFolder folder;
  folder.write("p.png", test::four_colors());
  const auto file = folder.write("s.json", json_scene(R"({"picture": "p.png"})"));
  EXPECT_EQ(load(file, {.texture_bytes = 1000}).warnings, std::vector<std::string>{});
  const Scene s = load(file, {.texture_bytes = 4});
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_SAYS(s.warnings[0], "1 of 1 pictures are made smaller");
  EXPECT_EQ(s.texturing.pictures[0]->width, 1u);
}

}  // namespace
}  // namespace kdray::scene
