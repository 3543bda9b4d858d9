#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <string>

#include "scene/import/files.h"
#include "scene/import/load.h"
#include "scene/model/check_scene.h"
#include "scene/pictures.h"
#include "scene/scratch.h"

namespace kdray::scene {
namespace {

using test::refusal;
using test::ScratchFolder;

Scene read(const std::string& text, const std::filesystem::path& file = "a.obj") {
  Scene scene = read_obj(text, file);
  check_scene(scene);
  return scene;
}

std::string refused(const std::string& text) {
  return refusal([&] { read_obj(text, "a.obj"); });
}

#define EXPECT_SAYS(message, part) EXPECT_NE((message).find(part), std::string::npos) << (message)

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
using Corners = std::array<std::uint32_t, 3>;

TEST(Obj, ReadsEveryFormOfCorner) {
  const Scene s = read(kSquare +
                       "vt 0 0\nvn 0 0 1\nf 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\nf 1/1/1 2/1/1 3/1/1\n"
                       "f -4 -3 -2\nf -4//-1 2//1 +3//1\nf 1/ 2/ 3/\nf 1// 2// 3//\n");
  ASSERT_EQ(s.triangles.size(), 8u);
  for (const Triangle& t : s.triangles) EXPECT_EQ(t.vertex, (Corners{0, 1, 2})) << t.number;
  for (const std::size_t smooth : {2u, 3u, 5u}) EXPECT_EQ(s.triangles[smooth].normal, (Corners{0, 0, 0}));
  for (const std::size_t flat : {0u, 1u, 4u, 6u, 7u}) EXPECT_EQ(s.triangles[flat].normal[0], kNone);
  EXPECT_TRUE(s.warnings.empty());
}

TEST(Obj, ReadsNumbersExactly) {
  const Scene s = read(
      "v 0.1 +1e-3 -.5\nv 123456.789012345678 1.7976931348623157e308 1e-400\nv 3. 2 1 0.5\n"
      "f 1 2 3\n");
  EXPECT_EQ(s.vertices[0], dvec3(0.1, 1e-3, -0.5));
  EXPECT_EQ(s.vertices[1], dvec3(123456.789012345678, 1.7976931348623157e308, 0));
  EXPECT_EQ(s.vertices[2], dvec3(3, 2, 1));
}

TEST(Obj, SaysWhatIsNoColour) {
  const std::string rest = "v 1 0 0 1\nv 0 1 0\nf 1 2 3\n";  // a weight is no colour
  for (const char* plain : {"v 0 0 0 1\n", "v 0 0 0\n"}) {
    const Scene s = read(plain + rest);
    EXPECT_TRUE(s.warnings.empty());
    EXPECT_TRUE(s.texturing.colors.empty());
  }
  const Scene s = read("v 0 0 0 1 0.5\n" + rest);
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_SAYS(s.warnings[0], "a.obj:1: 1 vertices have two numbers after their position, which are left out");
}

TEST(Obj, CutsPolygons) {
  const Scene s = read("v -1 -1 0\nv 0 0 0\nv 1 -1 0\nv 0 2 0\nf 1 2 3 4\n");
  ASSERT_EQ(s.triangles.size(), 2u);
  // The dent at vertex 2 must be a corner of both.
  for (const Triangle& t : s.triangles) EXPECT_TRUE(t.vertex[0] == 1 || t.vertex[1] == 1 || t.vertex[2] == 1);
}

TEST(Obj, JoinsLinesAndSkipsComments) {
  const Scene s =
      read("\xef\xbb\xbf# C:\\models\\\nv 0 0 0 # origin\r\nv 1 0 0\r\nv 1 1 0\r\rf 1 \\\r\n2 \\\n 3 # all");
  ASSERT_EQ(s.triangles.size(), 1u);
  EXPECT_EQ(s.vertices.size(), 3u);
}

TEST(Obj, FlattensFacesWithUselessNormals) {
  const Scene s = read(
      kSquare + "vn 0 0 0\nvn 0 0 9\nf 1//1 2//2 3//2\nf 1//2 2//2 3//2\nf 1//3 2//2 3//2\nf 1 2//2 3//2\n");
  EXPECT_EQ(s.triangles[0].normal[0], kNone);
  EXPECT_EQ(s.normals[s.triangles[1].normal[0]], vec3(0, 0, 1));
  EXPECT_EQ(s.triangles[2].normal[0], kNone);
  EXPECT_EQ(s.triangles[3].normal[0], kNone);
  ASSERT_EQ(s.warnings.size(), 2u);
  EXPECT_SAYS(s.warnings[0], "a.obj: 1 triangles have a corner normal without a direction");
  EXPECT_SAYS(s.warnings[1], "a.obj:9: 1 corners name a normal that does not exist");
}

TEST(Obj, RefusesWithTheLine) {
  EXPECT_SAYS(refused("v 1 2\n"), "a.obj:1: expected a vertex of three numbers, but the line ends");
  EXPECT_SAYS(refused("v 1 2 3\nv 1 x 3\n"),
              "a.obj:2: expected a vertex of three numbers (a finite number), found 'x'");
  EXPECT_SAYS(refused(kSquare + "\nf 1 2 5\n"), "a.obj:6: there is no vertex 5 (the file has 4)");
  EXPECT_SAYS(refused(kSquare + "f 1 2 -5\n"), "a.obj:5: there is no vertex -5");
  EXPECT_SAYS(refused(kSquare + "f 1 2 0\n"), "a.obj:5: there is no vertex 0 in '0'; vertices count from 1");
  EXPECT_SAYS(refused(kSquare + "f 1 2 x\n"),
              "a.obj:5: expected a corner like 7, 7/2, 7//3 or 7/2/3, found 'x'");
  EXPECT_SAYS(refused(kSquare + "f 1 2 99999999999999999999\n"), "a.obj:5: expected a corner");
  EXPECT_SAYS(refused(kSquare + "f 1 2 \\\n7\n"), "a.obj:6: there is no vertex 7");
  EXPECT_SAYS(refused("\x89PNG\nrubbish\n"), "a.obj: not an OBJ file");
  EXPECT_SAYS(refused("\xfe\xff\x00v"), "this is UTF-16 text");
}

TEST(Obj, WarnsOfWhatItLeavesOut) {
  const Scene s =
      read(kSquare + "f 1 2\nf\np 1\nl 1 2\nsurf 0 1 0 1 1 2 3 4\nnonsense\ng a\no b\ns off\nf 1 2 3\n");
  EXPECT_EQ(s.triangles.size(), 1u);
  ASSERT_EQ(s.warnings.size(), 4u);
  EXPECT_SAYS(s.warnings[0], "a.obj:5: 2 faces with fewer than 3 corners");
  EXPECT_SAYS(s.warnings[1], "a.obj:7: 2 points and lines");
  EXPECT_SAYS(s.warnings[2], "a.obj:9: 1 free-form");
  EXPECT_SAYS(s.warnings[3], "a.obj:10: 1 lines that are no OBJ statements");
}

TEST(Obj, FindsItsMaterials) {
  const ScratchFolder folder;
  folder.write("two words.mtl", "newmtl red one  \nKd 1 0 0\nillum 1\n");
  folder.write("b.mtl", "newmtl green\nKd 0 1 0\nillum 1\nnewmtl green\nKd 0 0 1\n");
  // usemtl before mtllib, names with spaces, a path from another machine, a material again after another.
  const std::string text = kSquare +
                           "f 1 2 3\nusemtl green\nf 1 2 3\nusemtl red one\nf 1 2 3\nmtllib two words.mtl\n"
                           "mtllib missing.mtl C:\\models\\b.mtl\nusemtl green\nf 1 2 3\n";
  const Scene s = read(text, folder / "a.obj");
  ASSERT_EQ(s.triangles.size(), 4u);
  const auto material = [&](std::size_t i) { return s.materials[s.triangles[i].material]; };
  EXPECT_EQ(material(0).diffuse, vec3(0.7f));
  EXPECT_EQ(material(1).diffuse, vec3(0, 1, 0));
  EXPECT_EQ(material(2).diffuse, vec3(1, 0, 0));
  EXPECT_EQ(s.triangles[1].material, s.triangles[3].material);
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_SAYS(s.warnings[0], ":11: no material file 'missing.mtl'");
}

TEST(Obj, GoesOnWithoutMaterials) {
  const ScratchFolder folder;
  const Scene s = read("mtllib none.mtl\nusemtl x\n" + kSquare + "f 1 2 3\n", folder / "a.obj");
  EXPECT_EQ(s.materials.size(), 1u);
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_SAYS(s.warnings[0], "a.obj:1: no material file 'none.mtl'");
  folder.write("b.mtl", "newmtl y\n");
  const Scene t = read("mtllib b.mtl\nusemtl x\n" + kSquare + "f 1 2 3\n", folder / "a.obj");
  ASSERT_EQ(t.warnings.size(), 1u);
  EXPECT_SAYS(t.warnings[0], "no material 'x' in its MTL files");
}

TEST(Obj, GoesOnWithADamagedMaterialFile) {
  const ScratchFolder folder;
  folder.write("bad.mtl", "newmtl a\n\nKd 1 nan 0\n");
  const Scene s = read("mtllib bad.mtl\nusemtl a\n" + kSquare + "f 1 2 3\n", folder / "a.obj");
  EXPECT_EQ(s.materials[0].diffuse, vec3(0.8f));
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_SAYS(s.warnings[0], "bad.mtl:3: 1 values of 'Kd' are not finite numbers");
}

TEST(Obj, JoinsLinesWithBlanksAfterTheBackslash) {
  const ScratchFolder folder;
  folder.write("a.mtl", "newmtl red\nKd 1 0 0\nnewmtl two words\nKd 0 1 0\n");
  folder.write("b.mtl", "newmtl blue\nKd 0 0 1\n");
  const Scene s = read(
      "mtllib a.mtl \\  \n b.mtl\n" + kSquare +
          "usemtl \\\nred\nf 1 \\ \n2 \\\t\r\n3\nusemtl \\ \n blue\nf 1 2 3\nusemtl two words\nf 1 2 3\n",
      folder / "a.obj");
  ASSERT_EQ(s.triangles.size(), 3u);
  const vec3 wanted[] = {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(s.materials[s.triangles[i].material].diffuse, wanted[i]) << i;
  EXPECT_TRUE(s.warnings.empty()) << s.warnings[0];
}

TEST(Obj, TakesFacesBeforeTheirPoints) {
  const std::string faces = "f 1/1/1 2/2/1 3/3/1\nf 1 2 3 4\n", relative = "f -4 -3 -2\n";
  const std::string points = kSquare + "vn 0 0 2\nvt 0 0\nvt 1 0\nvt 1 1\n";
  const Scene before = read(faces + points + relative), after = read(points + faces + relative);
  ASSERT_EQ(before.triangles.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(before.triangles[i].vertex, after.triangles[i].vertex) << i;
    EXPECT_EQ(before.triangles[i].normal, after.triangles[i].normal) << i;
  }
  EXPECT_TRUE(before.warnings.empty());
  // What counts back from where there is nothing yet stays without sense.
  EXPECT_SAYS(refused("f 1 2 3\nf -1 -2 -3\n" + kSquare), "a.obj:2: there is no vertex -1");
}

TEST(Obj, ReadsKeywordsInAnyCapitals) {
  const Scene s = read("V 0 0 0\nV 1 0 0\nV 0 1 0\nVN 0 0 1\nF 1//1 2//1 3//1\nG a\n");
  ASSERT_EQ(s.triangles.size(), 1u);
  EXPECT_EQ(s.triangles[0].normal[0], 0u);
  EXPECT_TRUE(s.warnings.empty());
}

TEST(Obj, FindsMaterialsInOtherCapitalsAndQuotes) {
  const ScratchFolder folder;
  folder.write("Scene.MTL",
               "NEWMTL Stone\nKD 1 0 0\nnewmtl \"old brick\"\nkd 0 1 0\nnewmtl A\nnewmtl a\nKd 0 0 1\n");
  const Scene s = read("mtllib \"scene.mtl\"\n" + kSquare +
                           "usemtl stone\nf 1 2 3\nusemtl Old Brick\nf 1 2 3\nusemtl a\nf 1 2 3\n",
                       folder / "a.obj");
  const vec3 wanted[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(s.materials[s.triangles[i].material].diffuse, wanted[i]) << i;
  EXPECT_TRUE(s.warnings.empty());
}

TEST(Obj, LeavesOutWhatIsNotFinite) {
  const std::string unused = "vt nan 0\nvn 0 0 nan\nv nan 0 1\nv 0 -inf 1\n";
  const Scene s =
      read("mtllib none\n" + kSquare + unused + "f 1/1/1 2/1/1 3/1/1\nf 1 2 3 5\nf 1 2 4\nf 2 3 6\n");
  ASSERT_EQ(s.triangles.size(), 5u);
  for (const std::size_t good : {0, 3}) EXPECT_NE(s.triangles[good].vertex[0], s.triangles[good].vertex[1]);
  for (const std::size_t bad : {1, 2, 4}) EXPECT_EQ(s.triangles[bad].vertex[0], s.triangles[bad].vertex[2]);
  EXPECT_EQ(s.triangles[0].normal[0], kNone);
  ASSERT_EQ(s.warnings.size(), 4u);
  EXPECT_SAYS(s.warnings[1], "a.obj:8: 2 vertices are not finite (this is the first): the 3 triangles");
  EXPECT_SAYS(s.warnings[2], "without a direction");
  EXPECT_SAYS(s.warnings[3], "a.obj:6: 1 texture coordinates are not finite");
}

TEST(Obj, FindsPicturesInOtherCapitalsAndBelowTheAssetRoot) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "Textures");
  std::filesystem::create_directories(folder / "elsewhere");
  folder.write("Textures/Brick Wall.PNG", test::four_colors());
  folder.write("elsewhere/a.png", test::four_colors());
  folder.write("a.mtl", "newmtl a\nMAP_KD \"textures\\brick wall.png\"\n");
  const std::string text = "mtllib a.mtl\nusemtl a\n" + kSquare + "f 1 2 3\n";
  const Scene s = read(text, folder / "a.obj");
  EXPECT_EQ(s.texturing.pictures.size(), 1u);
  EXPECT_TRUE(s.warnings.empty()) << s.warnings[0];
  // Of two that differ in capitals neither is meant.
  folder.write("B.png", test::four_colors());
  folder.write("b.PNG", test::four_colors());
  folder.write("a.mtl", "newmtl a\nmap_Kd b.png\n");
  EXPECT_TRUE(read(text, folder / "a.obj").texturing.pictures.empty());
  folder.write("a.mtl", "newmtl a\nmap_Kd " + (folder / "elsewhere/a.png").string() + "\n");
  const Scene none = read(text, folder / "a.obj");
  ASSERT_EQ(none.warnings.size(), 1u);
  EXPECT_SAYS(none.warnings[0], "--asset-root DIR");
  const AssetRoot root(folder / "elsewhere");
  EXPECT_EQ(read(text, folder / "a.obj").texturing.pictures.size(), 1u);
}

}  // namespace
}  // namespace kdray::scene
