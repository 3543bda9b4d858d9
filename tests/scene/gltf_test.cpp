#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "scene/gltf_samples.h"
#include "scene/import/files.h"
#include "scene/import/load.h"
#include "scene/model/check_scene.h"
#include "scene/model/frame.h"
#include "scene/model/instances.h"
#include "scene/model/tangents.h"
#include "scene/pictures.h"
#include "scene/scratch.h"

namespace kdray::scene {
namespace {

using nlohmann::json;
using test::bytes_of;
using test::GltfSample;
using test::refusal;
using test::ScratchFolder;
using test::square;

Scene read(const std::string& text, const std::filesystem::path& file = "a.gltf") {
  Scene scene = read_gltf(text, file);
  check_scene(scene);
  return scene;
}
Scene read(const GltfSample& sample) {
  return read(sample.text());
}

std::string refused(const std::string& text, const std::filesystem::path& file = "a.gltf") {
  return refusal([&] { read_gltf(text, file); });
}
std::string refused(const GltfSample& sample) {
  return refused(sample.text());
}

#define EXPECT_SAYS(message, part) EXPECT_NE((message).find(part), std::string::npos) << (message)

using Corners = std::array<std::uint32_t, 3>;

dvec3 facet_normal(const Scene& s, std::size_t i) {
  const auto& v = s.triangles[i].vertex;
  return glm::normalize(glm::cross(s.vertices[v[1]] - s.vertices[v[0]], s.vertices[v[2]] - s.vertices[v[0]]));
}

TEST(Gltf, ReadsASquare) {
  const Scene s = read(square());
  ASSERT_EQ(s.triangles.size(), 2u);
  EXPECT_EQ(s.vertices[2], dvec3(1, 1, 0));
  EXPECT_EQ(s.triangles[1].vertex, (Corners{0, 2, 3}));
  EXPECT_EQ(s.triangles[1].number, 1u);
  EXPECT_EQ(s.materials.size(), 1u);
  EXPECT_TRUE(s.warnings.empty());
}

TEST(Gltf, ReadsGlb) {
  const std::string positions = bytes_of<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  const std::string glb = square().glb(positions);
  EXPECT_EQ(read(glb, "a.glb").triangles.size(), 2u);
  std::string wrong = glb;
  wrong[4] = 1;
  EXPECT_SAYS(refused(wrong), "a GLB file of version 1, not 2");
  EXPECT_SAYS(refused(glb.substr(0, glb.size() - 1)), "the GLB header says");
  wrong = glb;
  wrong.replace(12, 4, "\xf0\xff\xff\xff");
  EXPECT_SAYS(refused(wrong), "chunk 0 says 4294967280 bytes");
  wrong = glb;
  wrong[16] = 'X';
  EXPECT_SAYS(refused(wrong), "the first chunk is not JSON");
  EXPECT_SAYS(refused(glb.substr(1), "a.glb"), "a.glb: not a GLB file");
  EXPECT_SAYS(refused("glTF"), "too short for a GLB file");
}

TEST(Gltf, ReadsBuffersBesideIt) {
  const ScratchFolder folder;
  folder.write("a b.bin", bytes_of<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) + "padding");
  GltfSample sample = square();
  auto& uri = sample.json["buffers"][0]["uri"];
  for (const std::string name : {"a%20b.bin", "a b.bin", "./a%20b.bin"}) {
    uri = name;
    EXPECT_EQ(read(sample.text(), folder / "a.gltf").triangles.size(), 2u);
  }
  uri = "none.bin";
  EXPECT_SAYS(refused(sample.text(), folder / "a.gltf"), "/buffers/0/uri: there is no file 'none.bin'");
  for (const std::string name :
       {"/etc/hostname", "../a.bin", "x/../../a.bin", "http://a/b.bin", "file:a", "%2e%2e/a"}) {
    uri = name;
    EXPECT_SAYS(refused(sample.text(), folder / "a.gltf"), "is not a file beside the scene");
  }
  uri = "data:application/octet-stream;base64,!!!!";
  EXPECT_SAYS(refused(sample), "/buffers/0/uri: not a data: URI in base64");
  uri = "data:application/octet-stream;base64,AAAA";
  EXPECT_SAYS(refused(sample), "/buffers/0: says 48 bytes, but there are 3");
  sample.json["buffers"][0].erase("uri");
  EXPECT_SAYS(refused(sample), "has neither a uri nor the binary chunk");
}

TEST(Gltf, ReadsAllModes) {
  GltfSample sample = square();
  auto& primitive = sample.primitive();
  primitive["indices"] = sample.indices<std::uint8_t>({0, 1, 3, 2, 0});
  primitive["mode"] = 5;
  Scene s = read(sample);
  ASSERT_EQ(s.triangles.size(), 3u);
  EXPECT_EQ(s.triangles[0].vertex, (Corners{0, 1, 3}));
  EXPECT_EQ(s.triangles[1].vertex, (Corners{1, 2, 3}));
  EXPECT_EQ(s.triangles[2].vertex, (Corners{3, 2, 0}));
  primitive["indices"] = sample.indices<std::uint32_t>({0, 1, 2, 3});
  primitive["mode"] = 6;
  s = read(sample);
  ASSERT_EQ(s.triangles.size(), 2u);
  EXPECT_EQ(s.triangles[1].vertex, (Corners{0, 2, 3}));
  primitive.erase("indices");
  EXPECT_EQ(read(sample).triangles.size(), 2u);
  primitive["mode"] = 4;
  s = read(sample);
  EXPECT_EQ(s.triangles.size(), 1u);
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_SAYS(s.warnings[0], "1 primitives have corners after their last whole triangle: they are left out");
  primitive["mode"] = 1;
  s = read(sample);
  EXPECT_EQ(s.triangles.size(), 0u);
  EXPECT_SAYS(s.warnings.at(0), "1 primitives of points or lines are left out: they have no surface");
  primitive["mode"] = 7;
  EXPECT_SAYS(refused(sample), "/meshes/0/primitives/0/mode: expected a mode from 0 to 6");
}

TEST(Gltf, ReadsInterleavedAndNormalizedData) {
  GltfSample sample = square();
  std::string bytes(4, 'x');
  for (int i = 0; i < 3; ++i) {
    bytes += bytes_of<std::int16_t>(
        {static_cast<std::int16_t>(i == 0 ? -32768 : 32767), 0, static_cast<std::int16_t>(i * 16384)});
    bytes += "--";
  }
  bytes.resize(bytes.size() - 2);  // the last element needs no full stride
  const int accessor = sample.accessor(sample.view(bytes, 8), 5122, "VEC3", 3);
  sample.json["accessors"][static_cast<std::size_t>(accessor)]["byteOffset"] = 4;
  sample.json["accessors"][static_cast<std::size_t>(accessor)]["normalized"] = true;
  sample.primitive()["attributes"]["POSITION"] = accessor;
  sample.primitive().erase("indices");
  const Scene s = read(sample);
  EXPECT_EQ(s.vertices[0], dvec3(-1, 0, 0));
  EXPECT_EQ(s.vertices[1], dvec3(1, 0, 16384.0 / 32767));
  sample.json["accessors"][static_cast<std::size_t>(accessor)]["count"] = 4;
  EXPECT_SAYS(refused(sample), "/accessors/2: its 4 elements reach beyond the 26 bytes of their buffer view");
}

TEST(Gltf, AppliesSparseAccessors) {
  GltfSample sample = square();
  const int indices = sample.view(bytes_of<std::uint8_t>({1, 3}));
  const int values = sample.view(bytes_of<float>({5, 6, 7, 8, 9, 10}));
  json& accessor = sample.json["accessors"][0];
  accessor["sparse"] = {{"count", 2},
                        {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                        {"values", {{"bufferView", values}}}};
  Scene s = read(sample);
  EXPECT_EQ(s.vertices[0], dvec3(0, 0, 0));
  EXPECT_EQ(s.vertices[1], dvec3(5, 6, 7));
  EXPECT_EQ(s.vertices[3], dvec3(8, 9, 10));
  accessor.erase("bufferView");  // then all others are zero
  s = read(sample);
  EXPECT_EQ(s.vertices[2], dvec3(0, 0, 0));
  EXPECT_EQ(s.vertices[1], dvec3(5, 6, 7));
  accessor["count"] = 3;
  EXPECT_SAYS(refused(sample), "/accessors/0/sparse/indices: names element 3, which is not there");
  accessor["count"] = 4000000000u;
  EXPECT_SAYS(refused(sample), "/accessors/0/count: as many zeros as that are not believed");
}

TEST(Gltf, PlacesNodes) {
  GltfSample sample = square();
  const double half = std::sqrt(0.5);
  sample.json["nodes"] = {{{"children", {1}}, {"translation", {10, 0, 0}}, {"rotation", {0, 0, half, half}}},
                          {{"mesh", 0}, {"scale", {2, 3, 4}}}};
  Scene s = read(sample);  // scaled, turned by 90 degrees about z, moved
  EXPECT_NEAR(s.vertices[1].x, 10, 1e-12);
  EXPECT_NEAR(s.vertices[1].y, 2, 1e-12);
  EXPECT_NEAR(s.vertices[3].x, 7, 1e-12);
  sample.json["nodes"][1] = {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}};
  sample.json["nodes"][0] = {{"children", {1}}};
  EXPECT_EQ(read(sample).vertices[0], dvec3(5, 6, 7));
  sample.json["nodes"][1]["matrix"] = {1, 2, 3};
  EXPECT_SAYS(refused(sample), "/nodes/1/matrix: expected 16 numbers");
}

// A mirrored instance shows the same side to the same eye.
TEST(Gltf, TurnsMirroredTrianglesOver) {
  GltfSample sample = square();
  const std::vector<float> normals = {0.6f, 0, 0.8f, 0, 0, 1, 0, 0, 1, 0, 0, 1};
  sample.primitive()["attributes"]["NORMAL"] = sample.vectors(normals);
  for (const json& scale : {json{1, 1, 1}, json{-2, 1, 1}, json{1, 1, -1}, json{-1, -1, -1}}) {
    sample.json["nodes"][0]["scale"] = scale;
    const Scene s = read(sample);
    const double side = scale[2].get<double>();
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(facet_normal(s, i).z, side, 1e-12) << scale;
      for (const std::uint32_t n : s.triangles[i].normal) EXPECT_GT(s.normals[n].z * side, 0.7) << scale;
    }
    // Perpendicular to what it was perpendicular to: (0.8, 0, -0.6), scaled.
    const dvec3 tangent(0.8 * scale[0].get<double>(), 0, -0.6 * scale[2].get<double>());
    EXPECT_NEAR(glm::dot(dvec3(s.normals[s.triangles[0].normal[0]]), tangent), 0, 1e-6) << scale;
  }
}

TEST(Gltf, RefusesLoopsAndGoesDeep) {
  GltfSample sample = square();
  sample.json["nodes"] = {{{"children", {1}}}, {{"children", {0}}}};
  EXPECT_SAYS(refused(sample), "/nodes/1/children/0: node 0 comes a second time");
  sample.json["nodes"] = {{{"children", {1, 2}}}, {{"children", {2}}}, json::object()};
  EXPECT_SAYS(refused(sample), "node 2 comes a second time");
  sample.json["nodes"] = json::array();
  constexpr int kDeep = 20000;
  for (int i = 0; i < kDeep; ++i)
    sample.json["nodes"].push_back({{"children", {i + 1}}, {"translation", {1, 0, 0}}});
  sample.json["nodes"].push_back({{"mesh", 0}});
  EXPECT_EQ(read(sample).vertices[0], dvec3(kDeep, 0, 0));
}

// Nested so deep that a reader which calls itself would run out of stack.
TEST(Gltf, RefusesDeepJson) {
  const std::string deep = "{\"asset\":{\"version\":\"2.0\",\"extras\":" + std::string(1000000, '[');
  EXPECT_SAYS(refused(deep), "a.gltf:1: not JSON");
  std::string closed = deep + std::string(1000000, ']') + "}}";
  EXPECT_EQ(read(closed).triangles.size(), 0u);
}

TEST(Gltf, RefusesWithThePlace) {
  EXPECT_SAYS(refused("{\n\"asset\": {,\n}"), "a.gltf:2: not JSON");
  EXPECT_SAYS(refused("{}"), "a.gltf: the scene: lacks 'asset'");
  EXPECT_SAYS(refused("[]"), "expected an object");
  EXPECT_SAYS(refused("{\"asset\": {\"version\": \"1.0\"}}"), "/asset/version: glTF '1.0' is not read");
  GltfSample sample = square();
  const auto broken = [&](const std::string& pointer, const json& value) {
    GltfSample copy = sample;
    copy.json[json::json_pointer(pointer)] = value;
    return refused(copy);
  };
  EXPECT_SAYS(broken("/scene", 1), "/scene: there is no 1 in /scenes (it has 1)");
  EXPECT_SAYS(broken("/nodes/0/mesh", -1), "/nodes/0/mesh: expected a number from 0");
  EXPECT_SAYS(broken("/nodes/0/mesh", 0.5), "/nodes/0/mesh: expected a whole number");
  EXPECT_SAYS(broken("/meshes/0/primitives/0/attributes/POSITION", 9),
              "there is no 9 in /accessors (it has 2)");
  EXPECT_SAYS(broken("/accessors/0/count", 5), "/accessors/0: its 5 elements reach beyond");
  EXPECT_SAYS(broken("/accessors/0/count", 9007199254740991u),
              "/accessors/0/count: expected fewer than 2^32");
  EXPECT_SAYS(broken("/accessors/0/byteOffset", 9007199254740991u),
              "/accessors/0: its 4 elements reach beyond");
  EXPECT_SAYS(broken("/accessors/0/type", "VEC4"), "/accessors/0/type: expected \"VEC3\"");
  EXPECT_SAYS(broken("/accessors/0/componentType", 5124),
              "/accessors/0/componentType: expected a component type");
  EXPECT_SAYS(broken("/accessors/1/componentType", 5126), "expected an unsigned integer type");
  EXPECT_SAYS(broken("/bufferViews/0/byteLength", 49),
              "/bufferViews/0: reaches to byte 49 of a buffer of 48");
  EXPECT_SAYS(broken("/bufferViews/0/byteOffset", 9007199254740991u), "/bufferViews/0: reaches to byte");
  EXPECT_SAYS(broken("/bufferViews/0/byteStride", 8), "/bufferViews/0/byteStride: does not fit");
  EXPECT_SAYS(broken("/bufferViews/0/buffer", 7), "/bufferViews/0/buffer: there is no 7 in /buffers");
  EXPECT_SAYS(broken("/nodes/0/translation", {1, 2}), "/nodes/0/translation: expected 3 numbers");
  EXPECT_SAYS(broken("/nodes/0", {{"mesh", 0}, {"scale", {1e308, 1, 1}}, {"translation", {1e308, 0, 0}}}),
              "/accessors/0: a node's transform makes a position infinite");
  sample.primitive()["indices"] = sample.indices<std::uint16_t>({0, 1, 4});
  EXPECT_SAYS(refused(sample), "/accessors/2: index 2 names vertex 4 of 4");
}

// Which nodes are shown is then the viewer's choice: those that are in no other one, each once.
TEST(Gltf, ShowsAllRootsOfAFileWithoutScenes) {
  GltfSample sample = square();
  sample.json.erase("scene"), sample.json.erase("scenes");
  sample.json["nodes"] = {{{"mesh", 0}},
                          {{"children", {0, 2}}, {"translation", {5, 0, 0}}},
                          {{"mesh", 0}},
                          {{"mesh", 0}, {"translation", {0, 7, 0}}}};
  const Scene s = read(sample);
  EXPECT_EQ(s.triangles.size(), 6u);
  EXPECT_EQ(s.bounds().lo, dvec3(0, 0, 0));
  EXPECT_EQ(s.bounds().hi, dvec3(6, 8, 0));
}

TEST(Gltf, LeavesHiddenNodesOut) {
  GltfSample sample = square();
  sample.json["extensionsRequired"] = {"KHR_node_visibility"};
  sample.json["nodes"] = {{{"mesh", 0}, {"children", {1}}}, {{"children", {2}}}, {{"mesh", 0}}};
  EXPECT_EQ(read(sample).triangles.size(), 4u);
  sample.json["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = true;
  EXPECT_TRUE(read(sample).warnings.empty());
  sample.json["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = false;
  const Scene s = read(sample);
  EXPECT_EQ(s.triangles.size(), 2u);
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_SAYS(s.warnings[0], "1 hidden nodes (KHR_node_visibility) are left out");
}

TEST(Gltf, TellsOfWhatItRequiresAndIsLeftOut) {
  GltfSample sample = square();
  sample.json["extensionsRequired"] = {"KHR_materials_unlit", "EXT_other_shapes", "KHR_animation_pointer"};
  sample.json["nodes"][0]["extensions"]["EXT_other_shapes"] = json::object();
  const Scene s = read(sample);
  EXPECT_EQ(s.triangles.size(), 2u);
  ASSERT_EQ(s.warnings.size(), 2u);
  EXPECT_EQ(s.warnings[0], "a.gltf: EXT_other_shapes of 1 object is left out, though the file requires it");
  EXPECT_EQ(s.warnings[1], "a.gltf: KHR_animation_pointer is left out, though the file requires it");
  sample.json["extensionsRequired"] = {"KHR_materials_unlit", "KHR_lights_punctual", "KHR_mesh_quantization"};
  sample.json["nodes"][0].erase("extensions");
  EXPECT_TRUE(read(sample).warnings.empty());
}

TEST(Gltf, LeavesOutWhatIsNotFinite) {
  GltfSample sample = square();
  auto& attributes = sample.primitive()["attributes"];
  const std::vector<float> ups = {0, 0, 1, 0, NAN, 1, 0, 0, 1, 0, 0, 1};
  attributes["NORMAL"] = sample.vectors(ups);
  const Scene normals = read(sample);
  EXPECT_EQ(normals.triangles[0].normal[0], kNone);
  EXPECT_NE(normals.triangles[1].normal[0], kNone);
  ASSERT_EQ(normals.warnings.size(), 1u);
  EXPECT_SAYS(normals.warnings[0], "1 triangles have a corner normal without a direction");
  attributes["COLOR_0"] = sample.vectors(ups);
  const Scene colors = read(sample);
  EXPECT_TRUE(colors.texturing.colors.empty());
  ASSERT_EQ(colors.warnings.size(), 2u);
  EXPECT_SAYS(colors.warnings[0], "1 primitives have colours that are not finite: they are left out");
  sample = square();
  sample.primitive()["attributes"]["POSITION"] = sample.vectors({0, 0, 0, 1, NAN, 0, 1, 1, 0, 0, 1, 0});
  const Scene s = read(sample);
  EXPECT_EQ(s.triangles[0].vertex, (std::array<std::uint32_t, 3>{1, 1, 1}));
  EXPECT_EQ(s.triangles[1].vertex, (std::array<std::uint32_t, 3>{0, 2, 3}));
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_SAYS(
      s.warnings[0],
      "a.gltf: /accessors/2: element 1: 1 vertices are not finite (this is the first): the 1 triangles");
}

TEST(Gltf, ReadsBuffersWhoseUrisAreWrittenOtherwise) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "Parts");
  std::filesystem::create_directories(folder / "in");
  folder.write("Parts/A b.bin", bytes_of<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}));
  folder.write("secret.bin", bytes_of<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}));
  GltfSample sample = square();
  auto& uri = sample.json["buffers"][0]["uri"];
  for (const std::string name :
       {"Parts\\A b.bin", "parts/a%20B.BIN", "Parts/A%20b.bin?v=3", "parts%5Ca b.bin#x"}) {
    uri = name;
    EXPECT_EQ(read(sample.text(), folder / "a.gltf").triangles.size(), 2u) << name;
  }
  const std::string absolute = (folder / "Parts/A b.bin").string();
  for (const std::string& name :
       {std::string("../Parts/A b.bin"), std::string("..\\parts\\a b.bin"), absolute}) {
    uri = name;
    EXPECT_SAYS(refused(sample.text(), folder / "in/a.gltf"),
                "is not a file beside the scene, or below; --asset-root DIR allows what is below DIR");
    const AssetRoot root(folder / "Parts");
    EXPECT_EQ(read(sample.text(), folder / "in/a.gltf").triangles.size(), 2u) << name;
  }
  // A link out of the root is no way out of it.
  const AssetRoot root(folder / "Parts");
  std::filesystem::create_symlink(folder / "secret.bin", folder / "Parts/link.bin");
  for (const std::string name : {"../Parts/link.bin", "../secret.bin", "../Parts/../secret.bin"}) {
    uri = name;
    EXPECT_SAYS(refused(sample.text(), folder / "in/a.gltf"), "is not a file beside the scene") << name;
  }
}

TEST(Gltf, ReadsGlbThatGoesOnBehindItsLength) {
  const std::string glb = square().glb(bytes_of<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}));
  for (const std::string& more : {std::string("x"), std::string(64, '\0'), std::string(20, '\xff')}) {
    const Scene s = read(glb + more, "a.glb");
    EXPECT_EQ(s.triangles.size(), 2u);
    ASSERT_EQ(s.warnings.size(), 1u);
    EXPECT_SAYS(s.warnings[0], "a.glb: " + std::to_string(more.size()) + " bytes behind the " +
                                   std::to_string(glb.size()) + " that the GLB header says");
  }
}

// A file of a few kilobytes can ask for any number of copies.
TEST(Gltf, BoundsWhatInstancesMake) {
  GltfSample sample;
  const std::string positions(std::size_t{12} * 30000, '\0');
  sample.primitive()["attributes"]["POSITION"] = sample.accessor(sample.view(positions), 5126, "VEC3", 30000);
  json nodes = json::array();
  json roots = json::array();
  for (int i = 0; i < 2000; ++i) nodes.push_back({{"mesh", 0}}), roots.push_back(i);
  sample.json["nodes"] = nodes;
  sample.json["scenes"][0]["nodes"] = roots;
  const Instancing copied(Instances::flat);
  EXPECT_SAYS(refused(sample), "the instances of this file make more than");
  const Instancing kept(Instances::automatic);
  EXPECT_EQ(read(sample).instances.size(), 2000u);
}

TEST(Gltf, ReadsTheFirstPerspectiveCamera) {
  GltfSample sample = square();
  sample.json["cameras"] = {{{"type", "orthographic"}, {"orthographic", json::object()}},
                            {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}}}}};
  sample.json["nodes"] = {{{"mesh", 0}, {"children", {1, 2}}, {"translation", {1, 0, 0}}},
                          {{"camera", 0}},
                          {{"camera", 1}, {"translation", {0, 2, 0}}, {"rotation", {0, 1, 0, 0}}}};
  const Scene s = read(sample);
  ASSERT_TRUE(s.camera);
  EXPECT_EQ(s.camera->from, dvec3(1, 2, 0));
  EXPECT_NEAR(s.camera->at.z, 1, 1e-12);  // turned about y: it looks along +z
  EXPECT_EQ(s.camera->vertical_fov, 0.5);
  EXPECT_EQ(s.camera->hither, 0.25);
  EXPECT_EQ(s.camera->aspect, 0) << "the file names none";
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_SAYS(s.warnings[0], "a camera is left out: 'xmag' is 0");
}

TEST(Gltf, ReadsAllCamerasInTheOrderOfTheirNodes) {
  GltfSample sample = square();
  sample.json["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"aspectRatio", 1.75}}}},
      {{"type", "orthographic"},
       {"orthographic", {{"xmag", 2.5}, {"ymag", 1}, {"znear", 0.5}, {"zfar", 9}}}}};
  sample.json["nodes"] = {
      {{"mesh", 0}, {"children", {1, 2}}}, {{"camera", 1}, {"translation", {0, 0, 7}}}, {{"camera", 0}}};
  const Scene s = read(sample);
  ASSERT_EQ(s.cameras.size(), 2u);
  EXPECT_EQ(s.camera->ortho_width, 5);
  EXPECT_EQ(s.camera->hither, 0.5);
  EXPECT_EQ(s.camera->from, dvec3(0, 0, 7));
  EXPECT_EQ(s.cameras[1].ortho_width, 0);
  EXPECT_EQ(s.cameras[1].vertical_fov, 0.5);
  EXPECT_EQ(s.cameras[0].aspect, 2.5);
  EXPECT_EQ(s.cameras[1].aspect, 1.75);
  EXPECT_TRUE(s.warnings.empty());
}

// glTF's cameras have a direction alone: what they look at is as far off as the scene's middle.
TEST(Gltf, CamerasLookAtWhatLiesBeforeThem) {
  GltfSample sample = square();
  sample.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}}}}};
  sample.json["nodes"] = {{{"mesh", 0}, {"children", {1, 2}}},
                          {{"camera", 0}, {"translation", {3, 0.5, 7}}},
                          {{"camera", 0}, {"translation", {0, 0, -7}}}};
  const Scene s = read(sample);
  ASSERT_EQ(s.cameras.size(), 2u);
  EXPECT_LT(glm::length(s.cameras[0].at - dvec3(3, 0.5, 0)), 1e-12);
  EXPECT_EQ(s.cameras[1].at, dvec3(0, 0, -8)) << "there is nothing before it";
  EXPECT_EQ(s.camera->at, s.cameras[0].at);
}

TEST(Gltf, ReadsAndExposesLights) {
  GltfSample sample = square();
  sample.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "directional"}, {"intensity", 50000}, {"color", {1, 0.5, 0}}},
      {{"type", "spot"},
       {"intensity", 800},
       {"range", 9},
       {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.3}}}},
      {{"type", "point"}}};
  sample.json["nodes"] = {{{"mesh", 0}, {"children", {1, 2, 3}}}};
  for (int i = 0; i < 3; ++i) {
    sample.json["nodes"].push_back(
        {{"translation", {0.5, 0.5, 10}}, {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
  }
  const Scene s = read(sample);
  ASSERT_EQ(s.lights.size(), 3u);
  EXPECT_EQ(s.lights[0].kind, LightKind::directional);
  EXPECT_EQ(s.lights[0].direction, dvec3(0, 0, -1));
  EXPECT_EQ(s.lights[1].kind, LightKind::spot);
  EXPECT_EQ(s.lights[1].range, 9);
  EXPECT_NEAR(s.lights[1].cos_outer, std::cos(0.3), 1e-6);
  EXPECT_EQ(s.lights[2].attenuation, dvec3(0, 0, 1));
  EXPECT_EQ(s.lights[2].position, dvec3(0.5, 0.5, 10));
  // All together give 1 at the middle, and keep their shares.
  const double sum = s.lights[0].color.x + (s.lights[1].color.x + s.lights[2].color.x) / 100;
  EXPECT_NEAR(sum, 1, 1e-5);
  EXPECT_NEAR(s.lights[0].color.x / s.lights[1].color.x, 50000.0 / 800, 1e-3);
  EXPECT_NEAR(s.lights[0].color.y / s.lights[0].color.x, 0.5, 1e-6);
  // A film's frames have one exposure, whatever moves in them.
  EXPECT_NEAR(s.framing.illuminance, 50000 + 801.0 / 100, 0.1);
  Scene first = s, further = s;
  first.framing.illuminance *= 2;
  set_view(further, {.headlight = 0.5}, 1, &first);
  ASSERT_EQ(further.lights.size(), 4u);
  EXPECT_EQ(further.lights[0].color, s.lights[0].color / 2.0f);
  EXPECT_EQ(further.lights[3].color, vec3(0.5f)) << "the headlight is as bright as it was asked for";
  sample.json["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 3;
  EXPECT_SAYS(refused(sample), "/nodes/1/extensions/KHR_lights_punctual/light: there is no such light");
}

TEST(Gltf, TellsOfWhatItLeavesOut) {
  GltfSample sample = square();
  sample.json["extensionsUsed"] = {"EXT_other", "KHR_xmp"};
  sample.json["extensions"]["KHR_xmp"] = json::object();
  sample.json["nodes"][0]["extensions"]["EXT_other"] = json::object();
  sample.json["meshes"][0]["extensions"]["EXT_other"] = json::object();
  sample.json["scenes"].push_back({{"nodes", {0}}});
  sample.json["animations"] = {{{"samplers", json::array()}, {"channels", json::array()}}};
  sample.primitive()["attributes"]["TEXCOORD_2"] = 0;
  sample.primitive()["attributes"]["COLOR_1"] = 0;
  sample.primitive()["attributes"]["_OWN"] = 0;
  sample.primitive()["targets"] = {{{"TEXCOORD_0", 0}}};
  json lines = sample.primitive();
  lines["mode"] = 1;
  lines["attributes"].erase("COLOR_1");
  sample.json["meshes"][0]["primitives"].push_back(lines);
  const std::vector<std::string> wanted = {
      "a.gltf: 1 animation is at rest; --time SECONDS shows a moment of one",
      "a.gltf: 1 further scene is left out",
      "a.gltf: 1 primitives of points or lines are left out: they have no surface",
      "a.gltf: COLOR_1 of 1 primitive is left out",
      "a.gltf: EXT_other of 2 objects is left out",
      "a.gltf: TEXCOORD_0 of 2 morph targets is left out",
      "a.gltf: TEXCOORD_2 of 2 primitives is left out"};
  EXPECT_EQ(read(sample).warnings, wanted);
}

// Where nothing bends normals, tangents are not looked at, however wrong.
TEST(Gltf, ReadsTangentsWhereNormalsAreBent) {
  GltfSample sample = square();
  sample.json["materials"] = {json::object()};
  json& attributes = sample.primitive()["attributes"];
  sample.primitive()["material"] = 0;
  attributes["NORMAL"] = sample.vectors({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  attributes["TANGENT"] = 0;
  EXPECT_TRUE(read(sample).warnings.empty());
  sample.json["materials"][0]["normalTexture"]["index"] = 0;
  sample.json["images"] = {{{"uri", "data:image/png;base64," + test::base64(test::four_colors())}}};
  sample.json["textures"] = {{{"source", 0}}};
  EXPECT_THROW(read(sample), Error);  // accessor 0 is one of positions
  const int view = sample.view(test::bytes_of<float>({0, 1, 0, -1, 0, 1, 0, -1, 0, 1, 0, -1, 0, 1, 0, -1}));
  attributes["TANGENT"] = sample.accessor(view, 5126, "VEC4", 4);
  const Scene s = read(sample);
  EXPECT_TRUE(s.warnings.empty());
  ASSERT_EQ(s.texturing.tangents.size(), 2u);
  const Tangent t = unpacked_tangent(s.texturing.tangents[1].uv[2]);
  EXPECT_LT(glm::length(t.direction - dvec3(0, 1, 0)), 1e-6);
  EXPECT_EQ(t.hand, -1);
  EXPECT_EQ(s.texturing.material_maps.at(s.materials.at(0).maps).tangents, 1u);
  attributes["TANGENT"] = sample.accessor(view, 5126, "VEC4", 3);
  const Scene few = read(sample);
  ASSERT_EQ(few.warnings.size(), 1u);
  EXPECT_NE(few.warnings[0].find("tangents that are not as many"), std::string::npos);
  EXPECT_EQ(few.texturing.tangents.size(), 2u);  // those of the coordinates, of which there are none
}

}  // namespace
}  // namespace kdray::scene
