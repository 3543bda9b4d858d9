// What    Files that are cut off anywhere, or with some bytes changed: each either loads, as a scene that
//         keeps all promises, or is refused in one line. Most telling under the sanitizers.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "scene/gltf_samples.h"
#include "scene/import/load.h"
#include "scene/import/obj/mtl.h"
#include "scene/model/check_scene.h"
#include "scene/model/instances.h"
#include "scene/pictures.h"
#include "scene/scratch.h"
#include "support/seed.h"

namespace kdray::scene {
namespace {

using Reader = std::function<Scene(std::string_view, const std::filesystem::path&)>;

void expect_safe(const Reader& reader, const std::string& text) {
  try {
    check_scene(reader(text, "a"));
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::input) << e.what();
    const std::string what = e.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
  }
}

void mutate(const Reader& reader, const std::string& good, int n_rounds) {
  EXPECT_NO_THROW(check_scene(reader(good, "a")));
  for (std::size_t n = 0; n < good.size(); ++n) expect_safe(reader, good.substr(0, n));
  const unsigned seed = test::seed_or(4711);
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < n_rounds; ++round) {
    std::string bad = good;
    const int n_changes = 1 + static_cast<int>(random() % 4);
    for (int i = 0; i < n_changes; ++i) {
      const std::size_t at = random() % bad.size();
      switch (random() % 4) {
        case 0:
          bad[at] = static_cast<char>(random());
          break;
        case 1:  // what numbers and counts are made of
          bad[at] = "0123456789-+.eE \n/"[random() % 18];
          break;
        case 2:
          bad.insert(at, 1, bad[random() % bad.size()]);
          break;
        default:
          bad.erase(at, 1 + random() % 3);
          if (bad.empty()) bad = "x";
      }
    }
    expect_safe(reader, bad);
  }
}

constexpr int kRounds = 4000;

std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty "
         "uchar "
         "red\nelement face 2\nproperty list uchar int vertex_indices\nelement tristrips 1\nproperty list "
         "int int "
         "vertex_indices\nend_header\n";
}

TEST(Mutations, OfAsciiPly) {
  mutate(read_ply,
         ply_header("ascii") + "0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0 1\n3 0 1 2\n4 0 1 2 3\n5 0 1 2 -1 3\n",
         kRounds);
}

TEST(Mutations, OfBinaryPly) {
  std::string data = ply_header("binary_little_endian");
  for (float i = 0; i < 4; ++i) data += test::bytes_of<float>({i, i * i, 1}) + "r";
  data += "\3" + test::bytes_of<std::int32_t>({0, 1, 2}) + "\4" + test::bytes_of<std::int32_t>({0, 1, 2, 3});
  data += test::bytes_of<std::int32_t>({5, 0, 1, 2, -1, 3});
  mutate(read_ply, data, kRounds);
}

TEST(Mutations, OfStl) {
  mutate(
      read_stl,
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
      "endsolid a\n",
      kRounds);
  std::string binary(80, 'b');
  binary += test::bytes_of<std::uint32_t>({2});
  for (int i = 0; i < 2; ++i) binary += test::bytes_of<float>({0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}) + "ab";
  mutate(read_stl, binary, kRounds);
}

TEST(Mutations, OfColouredStl) {
  std::string binary(std::string("COLOR=\xff\x80\x01\xff", 10) + std::string(70, 'b'));
  binary += test::bytes_of<std::uint32_t>({0});  // the size tells
  for (int i = 0; i < 2; ++i)
    binary += test::bytes_of<float>({0, 0, 1, 0, 0, 0, 1, 0, NAN, 0, 1, 0}) + "a\xff";
  mutate(read_stl, binary, kRounds);
  mutate(
      read_stl,
      "solid facet normal\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\nvertex 1 0 0\nvertex 0 1 0\nend "
      "loop\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendfacet\nend solid\n",
      kRounds);
}

// Faces first, lines that go on, numbers that are none.
TEST(Mutations, OfOddObj) {
  mutate(read_obj,
         "f 1/1/1 2/2/1 3/3/1\nMTLLIB \"a b.mtl\" \\ \n c\nv 0 0 nan\nv 1 0 0\nv 1 1 inf 1 0 nan\nvt nan "
         "0\nvt 0\nvt 1 1\nvn 0 0 nan\n"
         "usemtl \\\n'A'\nf 1 2 \\ \n3 2\nf -3 -2 -1\n",
         kRounds);
}

TEST(Mutations, OfTexturedPly) {
  const test::ScratchFolder folder;
  folder.write("a", test::four_colors());
  const Reader beside = [&](std::string_view text, const std::filesystem::path&) {
    return read_ply(text, folder / "s");
  };
  const std::string place = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string comments = "comment TextureFile a\ncomment TextureFile b\n";
  const std::string face =
      "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty "
      "int texnumber\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  mutate(beside,
         "ply\nformat ascii 1.0\n" + comments + place + face +
             "0 0 nan\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 6 0 0 1 0 nan 1 1 9 9 9\n4 0 1 2 3 8 0 0 1 0 1 1 0 1 0 1 "
             "2 3\n",
         kRounds);
  std::string data = "ply\nformat binary_little_endian 1.0\n" + comments + place +
                     "property float s\nproperty float t\nproperty float r\nproperty float g\nproperty float "
                     "b\nelement face 1\nproperty list "
                     "uchar int vertex_indices\nend_header\n";
  for (float i = 0; i < 4; ++i) data += test::bytes_of<float>({i, i * i, 1, i, NAN, 0.5f, 1, i});
  data += "\4" + test::bytes_of<std::int32_t>({0, 1, 2, 3});
  mutate(beside, data, kRounds);
}

TEST(Mutations, OfObj) {
  mutate(read_obj,
         "mtllib a.mtl\nv 0 0 0\nv 1 0 0 \\\n\nv 1 1 0\nv 0 1 0.5\nvt 0 0\nvn 0 0 1\nusemtl a b\nf 1 2 3\nf "
         "1//1 2//1 3//1 "
         "4//1\nf -1/1/-1 -2/1/1 -3/1/1\nl 1 2\n",
         kRounds);
}

Scene read_gltf_at_rest(std::string_view text, const std::filesystem::path& file) {
  return read_gltf(text, file);
}

TEST(Mutations, OfGltf) {
  test::GltfSample sample = test::square();
  sample.json["materials"] = {
      {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.5}}}}, {"alphaMode", "BLEND"}}};
  sample.primitive()["material"] = 0;
  sample.json["nodes"][0]["scale"] = {1, 2, 3};
  mutate(read_gltf_at_rest, sample.text(), kRounds);
  mutate(read_gltf_at_rest, sample.glb(test::bytes_of<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0})), kRounds);
}

TEST(Mutations, OfTexturedGltf) {
  test::GltfSample sample = test::square();
  auto& j = sample.json;
  j["images"] = {{{"uri", "data:image/png;base64," + test::base64(test::four_colors())}}};
  j["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9985}}};
  j["textures"] = {{{"source", 0}, {"sampler", 0}}};
  nlohmann::json info = {{"index", 0}, {"texCoord", 0}};
  info["extensions"]["KHR_texture_transform"] = {{"offset", {0.5, 1}}, {"scale", {2, 3}}, {"rotation", 1}};
  j["materials"] = {
      {{"pbrMetallicRoughness", {{"baseColorTexture", info}, {"metallicRoughnessTexture", info}}},
       {"normalTexture", {{"index", 0}, {"scale", 2}}},
       {"occlusionTexture", {{"index", 0}, {"strength", 0.5}}},
       {"emissiveTexture", info},
       {"emissiveFactor", {1, 2, 3}},
       {"alphaMode", "MASK"}}};
  sample.primitive()["material"] = 0;
  const int pairs = sample.view(test::bytes_of<float>({0, 0, 1, 0, 1, 1, 0, 1}));
  sample.primitive()["attributes"]["TEXCOORD_0"] = sample.accessor(pairs, 5126, "VEC2", 4);
  sample.primitive()["attributes"]["COLOR_0"] = 0;
  mutate(read_gltf_at_rest, sample.text(), kRounds);
}

// With tangents of its own, and with tangents that are made.
TEST(Mutations, OfGltfWithBentNormals) {
  test::GltfSample sample = test::square();
  auto& j = sample.json;
  auto& attributes = sample.primitive()["attributes"];
  j["images"] = {{{"uri", "data:image/png;base64," + test::base64(test::png(1, 1, 3, {128, 128, 255}))}}};
  j["textures"] = {{{"source", 0}}};
  j["materials"] = {{{"normalTexture", {{"index", 0}}}}};
  sample.primitive()["material"] = 0;
  const int pairs = sample.view(test::bytes_of<float>({0, 0, 1, 0, 1, 1, 0, 1}));
  attributes["TEXCOORD_0"] = sample.accessor(pairs, 5126, "VEC2", 4);
  attributes["NORMAL"] = sample.vectors({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  mutate(read_gltf_at_rest, sample.text(), kRounds);
  const int ways = sample.view(test::bytes_of<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}));
  attributes["TANGENT"] = sample.accessor(ways, 5126, "VEC4", 4);
  mutate(read_gltf_at_rest, sample.text(), kRounds);
}

TEST(Mutations, OfTexturedObj) {
  mutate(read_obj, "mtllib a\nv 0 0 0 1 0.5 0\nv 1 0 0 1\nv 1 1 0 0 0 1\nvt 0 0.5\nvt 1\nf 1/1 2/2 3/-1\n",
         kRounds);
}

// Materials with pictures of kdray's own; the picture is there, and everything else may be wrong.
TEST(Mutations, OfTexturedJson) {
  const test::ScratchFolder folder;
  folder.write("p", test::four_colors());
  const std::string good =
      R"({"materials":{"m":{"picture":"p","normal_picture":"p","emission_picture":"p","alpha":"mask",)"
      R"("metal_picture":"p","metallic":0.5,"roughness":1,"occlusion_picture":"p","occlusion":0}},)"
      R"("objects":[{"type":"triangles","vertices":[[0,0,0],[1,0,0],[1,1,0]],"faces":[[0,1,2]],)"
      R"("uv":[[0,0],[1,0],[0.5,1]],"material":"m"}]})";
  mutate([&](std::string_view text, const std::filesystem::path&) { return read_json(text, folder / "a"); },
         good, kRounds);
}

// Places of a mesh that is there, kept as they are and copied.
TEST(Mutations, OfInstancesInJson) {
  const test::ScratchFolder folder;
  folder.write("a.gltf", test::square().text());
  const std::string good =
      R"({"materials":{"m":{"color":[1,0,0]}},"objects":[{"type":"mesh","file":"a.gltf","scale":2,)"
      R"("instances":[{"translate":[5,0,0],"rotate":{"axis":[0,0,1],"angle":30}},)"
      R"({"scale":[-1,2,0.5],"material":"m"},{},{"matrix":[1,0,0,7,0,1,0,0,0,0,1,0,0,0,0,1]}]}]})";
  for (const Instances how : {Instances::kept, Instances::flat}) {
    const Instancing as(how);
    mutate([&](std::string_view text, const std::filesystem::path&) { return read_json(text, folder / "b"); },
           good, kRounds);
  }
}

TEST(Mutations, OfInstancesInGltf) {
  test::GltfSample sample = test::square();
  sample.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  auto& attributes = sample.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes["TRANSLATION"] = sample.vectors({0, 0, 0, 3, 0, 0, 0, 4, 0});
  attributes["SCALE"] = sample.vectors({1, 1, 1, 2, 2, 2, 1, -1, 3});
  for (const Instances how : {Instances::kept, Instances::flat}) {
    const Instancing as(how);
    mutate(read_gltf_at_rest, sample.text(), kRounds);
  }
}

TEST(Mutations, OfMtlPictures) {
  const std::string good =
      "newmtl a\nmap_Kd -s 1 2 3 -o 0.5 -clamp on -mm 0 1 -bm 2 -t 1 b c.png\nmap_Kd d\nmap_d e\nbump -bm 3 "
      "f\n";
  std::mt19937 random(28);
  for (int round = 0; round < kRounds; ++round) {
    std::string bad = good;
    for (int i = 0; i < 3; ++i) bad[random() % bad.size()] = " -somapKd0123.e\n\t"[random() % 17];
    std::vector<MtlMaterial> materials;
    std::vector<std::string> warnings;
    try {
      read_mtl(bad, "a", materials, warnings);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input) << e.what();
    }
    for (const MtlMaterial& m : materials)
      if (m.relief) {
        EXPECT_TRUE(std::isfinite(m.relief->strength)) << bad;
      }
    for (const MtlMaterial& m : materials)
      if (m.map_kd) {
        EXPECT_TRUE(std::isfinite(m.map_kd->scale[0] + m.map_kd->offset[1])) << bad;
      }
  }
}

}  // namespace
}  // namespace kdray::scene
