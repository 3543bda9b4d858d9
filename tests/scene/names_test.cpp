// What    The names of materials and parts as each format gives them, and names that do harm.
#include "scene/model/names.h"

#include <gtest/gtest.h>

#include <string>

#include "scene/gltf_samples.h"
#include "scene/import/load.h"
#include "scene/import/text_scanner.h"
#include "scene/scratch.h"

namespace kdray::scene {
namespace {

const std::string kCorners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", kFace = "f 1 2 3\n";

Scene obj(const std::string& text) {
  return read_obj(kCorners + text, "a.obj");
}

TEST(Names, OfObjAreObjectsAndMaterials) {
  const Scene s =
      obj(kFace + "o Cube\ng ignored\nusemtl red paint\n" + kFace + kFace + "o Empty\no Lid\n" + kFace);
  ASSERT_TRUE(s.names);
  EXPECT_EQ(s.names->of_primitive(0), "");
  EXPECT_EQ(s.names->of_primitive(1), "Cube");
  EXPECT_EQ(s.names->of_primitive(2), "Cube");
  EXPECT_EQ(s.names->of_primitive(3), "Lid");
  EXPECT_EQ(s.names->of_primitive(4), "");  // what a program adds
  EXPECT_EQ(s.names->of_material(0), "");
  EXPECT_EQ(s.names->of_material(1), "red paint");
  EXPECT_EQ(s.names->of_material(2), "");
}

TEST(Names, OfObjAreGroupsWhereThereAreNoObjects) {
  const Scene s = obj("g a\n" + kFace + "g b\n" + kFace + "g a\n" + kFace);
  ASSERT_TRUE(s.names);
  EXPECT_EQ(s.names->of_primitive(1), "b");
  EXPECT_EQ(s.names->of_primitive(2), "a");
  EXPECT_EQ(s.names->ends.size(), 3u);  // "", a, b: what has one name is one part
  EXPECT_FALSE(obj(kFace).names);
}

// A polygon's triangles are numbered one each.
TEST(Names, OfObjCountTriangles) {
  const Scene s = obj("v 1 1 0\no a\nf 1 2 4 3\no b\n" + kFace);
  EXPECT_EQ(s.names->of_primitive(1), "a");
  EXPECT_EQ(s.names->of_primitive(2), "b");
}

TEST(Names, OfGltfAreNodesOrElseMeshes) {
  test::GltfSample sample = test::square();
  sample.json["meshes"][0]["name"] = "Mesh";
  sample.json["materials"] = {{{"name", "Glass"}}};
  sample.primitive()["material"] = 0;
  sample.json["nodes"] = {{{"mesh", 0}, {"name", "Node"}}, {{"mesh", 0}}, {{"mesh", 0}, {"name", 5}}};
  sample.json["scenes"] = {{{"nodes", {0, 1, 2}}}};
  const Scene s = read_gltf(sample.text(), "a.gltf");
  ASSERT_TRUE(s.names);
  EXPECT_EQ(s.names->of_material(0), "Glass");
  EXPECT_EQ(s.names->of_primitive(1), "Node");
  EXPECT_EQ(s.names->of_primitive(2), "Mesh");
  EXPECT_EQ(s.names->of_primitive(4), "Mesh");  // a name that is no text is none
}

TEST(Names, OfGltfAreOfInstances) {
  test::GltfSample sample = test::square();
  sample.json["nodes"] = nlohmann::json::array();
  sample.json["scenes"][0]["nodes"] = nlohmann::json::array();
  for (int i = 0; i < 3; ++i) {
    sample.json["nodes"].push_back(
        {{"mesh", 0}, {"name", "n" + std::to_string(i)}, {"translation", {i, 0, 0}}});
    sample.json["scenes"][0]["nodes"].push_back(i);
  }
  const Instancing kept(Instances::kept);
  const Scene s = read_gltf(sample.text(), "a.gltf");
  ASSERT_EQ(s.instances.size(), 3u);
  EXPECT_EQ(s.names->of_instance(0), "n0");
  EXPECT_EQ(s.names->of_instance(2), "n2");
  EXPECT_EQ(s.names->of_instance(3), "");
}

TEST(Names, OfStlAreSolids) {
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  const Scene s = read_stl(
      "solid left half\n" + facet + "endsolid left half\nsolid right\n" + facet + "endsolid\n", "a.stl");
  ASSERT_TRUE(s.names);
  EXPECT_EQ(s.names->of_primitive(0), "left half");
  EXPECT_EQ(s.names->of_primitive(1), "right");
}

TEST(Names, OfJsonAreMaterialsItsOwnAndThoseOfItsFiles) {
  const test::ScratchFolder folder;
  folder.write("a.obj", kCorners + "usemtl brass\n" + kFace);
  const Scene s = read_json(R"({"materials": {"red": {"color": [1, 0, 0]}}, "objects": [
      {"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "red"},
      {"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": {"color": [0, 1, 0]}},
      {"type": "mesh", "file": "a.obj"}]})",
                            folder / "s.json");
  ASSERT_TRUE(s.names);
  EXPECT_EQ(s.names->of_material(0), "red");
  EXPECT_EQ(s.names->of_material(1), "");
  EXPECT_EQ(s.names->of_material(2), "brass");
}

TEST(Names, AreShownSafely) {
  EXPECT_EQ(printable("a\x1b[31m\xc2\x9b"
                      "b\x7f"),
            "a?[31m?b?");                                      // C1 has escapes, too
  EXPECT_EQ(printable("\xff\xc0\xaf\xed\xa0\x80"), "??????");  // no UTF-8, overlong, a surrogate
  EXPECT_EQ(printable("\xe2\x80\xae"
                      "gpj.exe"),
            "?gpj.exe");  // written from right to left
  EXPECT_EQ(printable("Gr\xc3\xbc\xc3\x9f"
                      "e \xe6\x9d\xb1 \xf0\x9f\x98\x80"),
            "Gr\xc3\xbc\xc3\x9f"
            "e \xe6\x9d\xb1 \xf0\x9f\x98\x80");
  EXPECT_EQ(printable("\xc3\xbc\xc3\xbc", 3), "\xc3\xbc...");  // cut between characters
  EXPECT_EQ(printable("\xc3"), "?");
  const Scene s = obj("o " + std::string(1 << 20, 'x') + "\nusemtl a\tb\x1b[2J\n" + kFace);
  EXPECT_EQ(s.names->of_primitive(0).size(), 203u);
  EXPECT_EQ(s.names->of_material(0), "a?b?[2J");
}

// Of a file whose faces change between two groups, and of one of many objects.
TEST(Names, TakeLittleMemory) {
  std::string two, many;
  for (int i = 0; i < 40000; ++i) {
    two += (i % 2 == 0 ? "g a\n" : "g b\n") + kFace;
    many += "o object " + std::to_string(i) + "\n" + kFace;
  }
  EXPECT_LE(obj(two).names->bytes(), 40000 * 9u);
  const Scene s = obj(many);
  EXPECT_LE(s.names->bytes(), 40000 * 34u);
  EXPECT_EQ(s.names->of_primitive(39999), "object 39999");
}

TEST(Names, MaterialsAreFoundByThePrimitivesNumber) {
  const Scene s = read_json(R"({"materials": {"red": {"color": [1, 0, 0]}}, "objects": [
      {"type": "sphere", "center": [0, 0, 0], "radius": 1},
      {"type": "triangles", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]],
       "material": "red"},
      {"type": "sphere", "center": [0, 0, 0], "radius": 2, "material": "red"}]})",
                            "s.json");
  ASSERT_TRUE(s.names);
  const auto name = [&](std::uint32_t number) { return s.names->of_material(s.material_of(number)); };
  EXPECT_EQ(name(0), "");
  EXPECT_EQ(name(1), "red");
  EXPECT_EQ(name(2), "red");
  EXPECT_EQ(s.material_of(3), kNone);
  EXPECT_EQ(s.material_of(0, 0), kNone);  // there are no instances
}

}  // namespace
}  // namespace kdray::scene
