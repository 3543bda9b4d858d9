// What of pictures and colours at corners files say, and how it comes to lie beside the triangles.
#include "scene/textures/texturing.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "scene/gltf_samples.h"
#include "scene/import/load.h"
#include "scene/model/check_scene.h"
#include "scene/pictures.h"
#include "scene/scratch.h"

namespace kdray::scene {
namespace {

using nlohmann::json;

#define EXPECT_SAYS(message, part) EXPECT_NE((message).find(part), std::string::npos) << (message)

double curve(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

// Red, green, blue and alpha of a corner, from 0 to 1.
std::array<double, 4> corner(const Scene& s, std::size_t triangle, std::size_t at) {
  const auto& c = s.texturing.colors.at(triangle).c[at];
  return {(c[0] & 65535u) / 65535.0, (c[0] >> 16) / 65535.0, (c[1] & 65535u) / 65535.0,
          (c[1] >> 16) / 65535.0};
}

void expect_color(const Scene& s, std::size_t triangle, std::size_t at, const std::array<double, 4>& wanted) {
  const auto got = corner(s, triangle, at);
  for (std::size_t c = 0; c < 4; ++c)
    EXPECT_NEAR(got[c], wanted[c], 1e-5) << triangle << ", " << at << ", " << c;
}

const MaterialMaps& maps_of(const Scene& s, std::size_t triangle) {
  return s.texturing.material_maps.at(s.materials.at(s.triangles.at(triangle).material).maps);
}

Scene checked(Scene s) {
  check_scene(s);
  return s;
}

const std::string kPlyColors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";

std::string ply_of(const std::string& format, const std::string& colors, const std::string& rows) {
  return "ply\nformat " + format +
         " 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" + colors +
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + rows;
}

TEST(Textures, OfAsciiPly) {
  const Scene s = checked(read_ply(
      ply_of("ascii", kPlyColors, "0 0 0 255 0 51\n1 0 0 0 128 0\n0 1 0 255 255 255\n3 0 1 2\n"), "a.ply"));
  EXPECT_TRUE(s.warnings.empty());
  expect_color(s, 0, 0, {1, 0, curve(0.2), 1});
  expect_color(s, 0, 1, {0, curve(128 / 255.0), 0, 1});
  expect_color(s, 0, 2, {1, 1, 1, 1});
  EXPECT_EQ(maps_of(s, 0).colored, 1u);
  EXPECT_EQ(maps_of(s, 0).diffuse, vec3(1));
  EXPECT_EQ(s.materials[0].diffuse, vec3(0));
}

TEST(Textures, OfBinaryPlyWithAlphaAndFloats) {
  std::string rows;
  for (float i = 0; i < 3; ++i)
    rows += test::bytes_of<float>({i, i * i, 0, 0.5f, 1, 0, 0.25f}) + std::string(1, 'x');
  rows += "\3" + test::bytes_of<std::int32_t>({0, 1, 2});
  const std::string colors =
      "property float red\nproperty float green\nproperty float blue\nproperty float alpha\nproperty uchar "
      "quality\n";
  const Scene s = checked(read_ply(ply_of("binary_little_endian", colors, rows), "a.ply"));
  for (std::size_t k = 0; k < 3; ++k) expect_color(s, 0, k, {curve(0.5), 1, 0, 0.25});
}

TEST(Textures, OfPlyWithTwoColoursOnlyIsNone) {
  const Scene s = checked(read_ply(ply_of("ascii", "property uchar red\nproperty uchar green\n",
                                          "0 0 0 1 1\n1 0 0 1 1\n0 1 0 1 1\n3 0 1 2\n"),
                                   "a.ply"));
  EXPECT_TRUE(s.texturing.colors.empty());
  EXPECT_TRUE(s.texturing.material_maps.empty());
}

TEST(Textures, OfObjVertices) {
  const Scene s =
      checked(read_obj("v 0 0 0 1 0.5 0\nv 1 0 0\nv 1 1 0 1 0 0 1\nv 0 1 0 0 1 0\nf 1 2 3 4\n", "a.obj"));
  EXPECT_TRUE(s.warnings.empty());
  ASSERT_EQ(s.triangles.size(), 2u);
  for (std::size_t t = 0; t < 2; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::array<std::array<double, 4>, 4> wanted = {
          {{1, curve(0.5), 0, 1}, {1, 1, 1, 1}, {0, 0, 1, 1}, {0, 1, 0, 1}}};
      expect_color(s, t, k, wanted[s.triangles[t].vertex[k]]);
    }
}

TEST(Textures, OfObjVerticesInBytes) {
  const Scene s =
      checked(read_obj("v 0 0 0 255 0 51\nv 1 0 0 0 0 0\nv 1 1 0 255 255 255\nf 1 2 3\n", "a.obj"));
  expect_color(s, 0, 0, {1, 0, curve(0.2), 1});
}

TEST(Textures, OfObjPicture) {
  const test::ScratchFolder folder;
  folder.write("a picture.png", test::four_colors());
  folder.write("a.mtl",
               "newmtl m\nKd 0.5 1 1\nKs 0.25 0.25 0.25\nNs 10\n"
               "map_Kd -blendu on -s 2 3 1 -o 0.25 -clamp on C:\\somewhere\\a picture.png\n");
  const auto file = folder.write(
      "a.obj",
      "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\n"
      "f 1/1 2/2 3/3 4/-1\n");
  const Scene s = checked(import_scene(file));
  EXPECT_EQ(s.warnings, std::vector<std::string>{});
  ASSERT_EQ(s.texturing.pictures.size(), 1u);
  EXPECT_EQ(s.texturing.pictures[0]->width, 2u);
  const MaterialMaps& maps = maps_of(s, 0);
  EXPECT_EQ(maps.diffuse, vec3(0.5f, 1, 1));
  EXPECT_EQ(s.materials[0].specular, vec3(0.25f));
  const Texture& t = s.texturing.textures.at(maps.base);
  EXPECT_EQ(t.wrap_across, Wrap::clamp);
  EXPECT_TRUE(t.curved);
  // The corner (u, v) of the file is looked at 2u + 0.25 from the left and 3v from the lower edge.
  ASSERT_EQ(s.texturing.texcoords[0].size(), 2u);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const dvec3& at = s.vertices[s.triangles[i].vertex[k]];  // u and v are x and y
      const auto& uv = s.texturing.texcoords[0][i].uv[k];
      EXPECT_NEAR(t.across[0] * uv[0] + t.across[1] * uv[1] + t.across[2], 2 * at.x + 0.25, 1e-6);
      EXPECT_NEAR(t.down[0] * uv[0] + t.down[1] * uv[1] + t.down[2], 1 - 3 * at.y, 1e-6);
    }
}

TEST(Textures, OfObjWithoutItsPicture) {
  const test::ScratchFolder folder;
  folder.write("a.mtl", "newmtl m\nKd 0 0 0\nmap_Kd gone.png\nnewmtl n\nmap_Kd a.tga\n");
  folder.write("a.tga", "no picture");
  const auto file = folder.write(
      "a.obj",
      "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\nusemtl n\nf 1 2 3\n");
  const Scene s = checked(load(file));
  ASSERT_EQ(s.warnings.size(), 2u);
  EXPECT_SAYS(s.warnings[0], "a.obj: no picture 'gone.png'");
  EXPECT_SAYS(s.warnings[0], "(the picture is left out)");
  EXPECT_SAYS(s.warnings[1], "is neither PNG, JPEG nor WebP");
  EXPECT_TRUE(s.texturing.material_maps.empty());
  EXPECT_TRUE(s.texturing.texcoords[0].empty());
  EXPECT_EQ(s.materials[0].diffuse, vec3(0.6f));
}

// A square with a picture as its base colour; `change` may do something to the file.
template <class Change>
Scene textured(const Change& change, std::string picture = test::four_colors()) {
  test::GltfSample sample = test::square();
  json& j = sample.json;
  j["images"] = {{{"uri", "data:image/png;base64," + test::base64(picture)}}};
  j["textures"] = {{{"source", 0}}};
  j["materials"] = {{{"pbrMetallicRoughness",
                      {{"baseColorTexture", {{"index", 0}}},
                       {"baseColorFactor", {0.5, 1, 1, 0.25}},
                       {"metallicFactor", 0}}}}};
  sample.primitive()["material"] = 0;
  const int pairs = sample.view(test::bytes_of<float>({0, 0, 1, 0, 1, 1, 0, 1}));
  sample.primitive()["attributes"]["TEXCOORD_0"] = sample.accessor(pairs, 5126, "VEC2", 4);
  change(sample);
  return checked(read_gltf(sample.text(), "a.gltf"));
}
Scene textured() {
  return textured([](test::GltfSample&) {});
}

TEST(Textures, OfGltfTexture) {
  const Scene s = textured();
  EXPECT_EQ(s.warnings, std::vector<std::string>{});
  const MaterialMaps& maps = maps_of(s, 0);
  EXPECT_EQ(maps.diffuse, vec3(0.5f, 1, 1));
  EXPECT_EQ(maps.mode, Alpha::opaque);
  EXPECT_EQ(s.materials[0].diffuse, vec3(0));
  const Texture& t = s.texturing.textures.at(maps.base);
  EXPECT_EQ(t, (Texture{.picture = 0, .minify = Minify::linear_mipmap_linear}));
  EXPECT_EQ(test::bytes_of(*s.texturing.pictures[0]),
            (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255}));
  ASSERT_EQ(s.texturing.texcoords[0].size(), 2u);
  EXPECT_EQ(s.texturing.texcoords[0][1].uv[2][1], 1);  // corner 3
}

TEST(Textures, OfGltfSamplerSetAndTransform) {
  const Scene s = textured([](test::GltfSample& sample) {
    json& j = sample.json;
    j["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
    j["textures"][0]["sampler"] = 0;
    const int pairs = sample.view(test::bytes_of<std::uint16_t>({0, 0, 65535, 0, 65535, 65535, 0, 65535}));
    const int second = sample.accessor(pairs, 5123, "VEC2", 4);
    j["accessors"][static_cast<std::size_t>(second)]["normalized"] = true;
    sample.primitive()["attributes"]["TEXCOORD_1"] = second;
    j["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
        {"offset", {0.5, 0.25}}, {"scale", {2, 3}}, {"rotation", 1.5707963267948966}, {"texCoord", 1}};
  });
  EXPECT_EQ(s.warnings, std::vector<std::string>{});
  const Texture& t = s.texturing.textures.at(maps_of(s, 0).base);
  EXPECT_EQ(t.wrap_across, Wrap::clamp);
  EXPECT_EQ(t.wrap_down, Wrap::mirror);
  EXPECT_TRUE(t.nearest);
  EXPECT_EQ(t.set, 1u);
  const std::array<float, 3> across{0, 3, 0.5f}, down{-2, 0, 0.25f};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(t.across[k], across[k], 1e-6);
    EXPECT_NEAR(t.down[k], down[k], 1e-6);
  }
  ASSERT_EQ(s.texturing.texcoords[1].size(), 2u);
  EXPECT_EQ(s.texturing.texcoords[1][0].uv[2][0], 1);
}

TEST(Textures, OfGltfAlpha) {
  const auto with = [](const char* mode) {
    return textured([&](test::GltfSample& sample) {
      sample.json["materials"][0]["alphaMode"] = mode;
      sample.json["materials"][0]["alphaCutoff"] = 0.125;
    });
  };
  const Scene blend = with("BLEND"), mask = with("MASK");
  EXPECT_EQ(maps_of(blend, 0).mode, Alpha::blend);
  EXPECT_EQ(maps_of(blend, 0).alpha, 0.25f);
  EXPECT_EQ(maps_of(blend, 0).diffuse, vec3(0.5f, 1, 1));
  EXPECT_EQ(maps_of(mask, 0).mode, Alpha::mask);
  EXPECT_EQ(maps_of(mask, 0).cutoff, 0.125f);
}

// Without a picture a mask is all there or all a hole.
TEST(Textures, OfGltfMaskByTheFactorAlone) {
  const auto with = [](double alpha) {
    return textured([&](test::GltfSample& sample) {
      sample.json["materials"] = {
          {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, alpha}}}}, {"alphaMode", "MASK"}}};
    });
  };
  EXPECT_TRUE(with(0.5).texturing.material_maps.empty());
  EXPECT_EQ(maps_of(with(0.25), 0).mode, Alpha::mask);
}

TEST(Textures, OfGltfColours) {
  const Scene s = textured([](test::GltfSample& sample) {
    const int bytes =
        sample.view(std::string("\xff\x80\x00\x33\xff\xff\xff\xff\x00\x00\x00\x00\xff\xff\xff\xff", 16));
    const int colors = sample.accessor(bytes, 5121, "VEC4", 4);
    sample.json["accessors"][static_cast<std::size_t>(colors)]["normalized"] = true;
    sample.primitive()["attributes"]["COLOR_0"] = colors;
    sample.primitive().erase("material");
  });
  expect_color(s, 0, 0, {1, 128 / 255.0, 0, 0.2});  // linear, as glTF has them
  expect_color(s, 1, 1, {0, 0, 0, 0});
  EXPECT_EQ(maps_of(s, 0).colored, 1u);
  EXPECT_EQ(maps_of(s, 0).diffuse, vec3(1));
}

TEST(Textures, SaysWhichPictureIsLeftOut) {
  const auto warning = [](const auto& change) {
    const Scene s = textured(change);
    EXPECT_TRUE(s.texturing.material_maps.empty());
    EXPECT_EQ(s.materials[0].diffuse, vec3(0.5f, 1, 1));
    EXPECT_EQ(s.warnings.size(), 1u);
    return s.warnings.empty() ? "" : s.warnings[0];
  };
  EXPECT_SAYS(warning([](auto& f) { f.json["images"][0]["uri"] = "gone.png"; }),
              "there is no file 'gone.png'");
  EXPECT_SAYS(warning([](auto& f) { f.json["images"][0]["uri"] = "data:image/png;base64,AAAA"; }),
              "a.gltf: image 0: is neither PNG, JPEG nor WebP");
  EXPECT_SAYS(warning([](auto& f) { f.json["textures"][0].erase("source"); }), "names no PNG, JPEG or WebP");
  EXPECT_SAYS(warning([](auto& f) {
                f.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 2;
              }),
              "uses TEXCOORD_2");
}

TEST(Textures, OfPartsComesTogether) {
  const test::ScratchFolder folder;
  folder.write("p.png", test::four_colors());
  folder.write("a.mtl", "newmtl m\nmap_Kd p.png\n");
  folder.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 1\nvt 1 0\nusemtl m\nf 1/1 2/2 3/2\n");
  folder.write("b.ply",
               ply_of("ascii", kPlyColors, "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n3 0 1 2\n"));
  const auto file = folder.write(
      "s.json",
      R"({"objects": [{"type": "triangles", "vertices": [[0,0,0],[1,0,0],[0,1,0]], "faces": [[0,1,2]]},
        {"type": "mesh", "file": "a.obj"}, {"type": "mesh", "file": "b.ply"},
        {"type": "mesh", "file": "a.obj"},
        {"type": "mesh", "file": "b.ply", "material": {"kd": 0.5}}]})");
  const Scene s = checked(import_scene(file));
  ASSERT_EQ(s.triangles.size(), 5u);
  EXPECT_EQ(s.texturing.material_maps.size(), 2u);
  EXPECT_EQ(s.texturing.textures.size(), 1u);
  EXPECT_EQ(s.materials[s.triangles[0].material].maps, kNone);
  EXPECT_EQ(s.materials[s.triangles[4].material].maps, kNone);
  EXPECT_EQ(s.triangles[1].material, s.triangles[3].material);
  EXPECT_EQ(maps_of(s, 2).colored, 1u);
  expect_color(s, 2, 1, {0, 1, 0, 1});
  expect_color(s, 1, 0, {1, 1, 1, 1});
  EXPECT_EQ(s.texturing.texcoords[0].at(3).uv[1][0], 1);
  EXPECT_EQ(s.texturing.texcoords[0].at(2).uv[1][0], 0);
}

// A mesh file keeps the coordinates that the JSON file's picture needs, whatever it says of pictures itself.
TEST(Textures, OfJsonLieOnMeshesThatNameNone) {
  const test::ScratchFolder folder;
  folder.write("p.png", test::four_colors());
  folder.write("plain.mtl", "newmtl m\nKd 1 0 0\n");
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0.25 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n";
  folder.write("a.obj", square);
  folder.write("b.obj", "mtllib plain.mtl\nusemtl m\n" + square);
  folder.write(
      "c.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\n"
      "end_header\n0 0 0 0.25 0\n1 0 0 1 0\n1 1 0 1 1\n3 0 1 2\n");
  for (const std::string name : {"a.obj", "b.obj", "c.ply"}) {
    const auto file =
        folder.write("s.json", R"({"objects": [{"type": "mesh", "file": ")" + name +
                                   R"(", "material": {"picture": "p.png"}}, {"type": "mesh", "file": ")" +
                                   name + R"("}]})");
    const Scene s = checked(import_scene(file));
    EXPECT_EQ(s.warnings.size(), name == "c.ply" ? 1u : 0u) << "s and t of the second one are left out";
    ASSERT_FALSE(s.texturing.texcoords[0].empty()) << name;
    EXPECT_EQ(s.texturing.texcoords[0][0].uv[0][0], 0.25f) << name;
    EXPECT_NE(maps_of(s, 0).base, kNone) << name;
    EXPECT_EQ(s.materials[s.triangles[1].material].maps, kNone) << name;
  }
  EXPECT_TRUE(load(folder / "a.obj").texturing.texcoords[0].empty()) << "nothing shows them";
}

// Each side shows all of it, upright and not mirrored to who looks at it from outside.
TEST(Textures, OfJsonLieOnBoxesAndNotOnOtherShapes) {
  const test::ScratchFolder folder;
  folder.write("p.png", test::four_colors());
  const auto file = folder.write("s.json",
                                 R"({"materials": {"m": {"picture": "p.png"}}, "objects": [
        {"type": "box", "min": [-1, 2, 3], "max": [1, 5, 9], "material": "m"},
        {"type": "sphere", "center": [5, 0, 0], "radius": 1, "material": "m"},
        {"type": "cylinder", "base": [9, 0, 0], "apex": [9, 1, 0], "radius": 1,
         "material": {"normal_picture": "p.png"}},
        {"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0],
         "material": {"emission_picture": "p.png"}}]})");
  const Scene s = checked(import_scene(file));
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_SAYS(s.warnings[0], "/objects/1: shapes show one place");
  ASSERT_EQ(s.triangles.size(), 12u);
  ASSERT_EQ(s.texturing.texcoords[0].size(), 12u);
  double area = 0;
  for (std::size_t i = 0; i < 12; ++i) {
    std::array<dvec3, 3> p, uv;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = s.vertices[s.triangles[i].vertex[k]];
      const auto& at = s.texturing.texcoords[0][i].uv[k];
      uv[k] = {at[0], at[1], 0};
      if (std::abs(p[0].x - p[1].x) + std::abs(p[0].x - p[2].x) == 0 || p[0].z == p[1].z) continue;
    }
    const dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]), m = glm::cross(uv[1] - uv[0], uv[2] - uv[0]);
    EXPECT_LT(m.z, 0) << i << ": rows go down, so it turns the other way round where it isn't mirrored";
    area -= m.z / 2;
    if (n.y != 0) continue;
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(uv[k].y, p[k].y == 5 ? 0 : 1) << i;
  }
  EXPECT_EQ(area, 6);
}

}  // namespace
}  // namespace kdray::scene
