#include "scene/import/load.h"

#include <limits>

#include "scene/model/check_scene.h"
#include "scene/scratch.h"

namespace kdray::scene {
namespace {

using test::refusal;
using test::ScratchFolder;

TEST(Load, FramesWhatTheFileLeavesOpen) {
  const ScratchFolder folder;
  const Scene s = load(folder.write("ball.NFF", "f 1 1 1 1 0 1 0 0\ns 5 5 5 1\n"));
  EXPECT_TRUE(s.camera);
  EXPECT_EQ(s.lights.size(), 2u);
  const Scene lit = load(folder.write("lit.nff", "f 1 1 1 1 0 1 0 0\ns 5 5 5 1\nl 0 9 0\n"));
  EXPECT_EQ(lit.lights.size(), 1u);
}

TEST(Load, TakesASceneOfNothing) {
  const ScratchFolder folder;
  for (const Scene& s : {load(folder.write("a.nff", "b 1 0 0\n")),
                         load(folder.write("a.json", "{\"background\": [1, 0, 0]}"))}) {
    EXPECT_EQ(s.primitive_count(), 0u);
    EXPECT_EQ(s.background, vec3(1, 0, 0));
    EXPECT_TRUE(s.camera);
    EXPECT_EQ(s.warnings,
              std::vector<std::string>{s.name + ": there are no surfaces in it: nothing of it will be seen"});
  }
  const Scene none = load(folder.write("a.stl", "solid\nendsolid\n"));
  ASSERT_EQ(none.warnings.size(), 1u);
  EXPECT_EQ(none.warnings[0], none.name + ": there are no surfaces in it: nothing of it will be seen");
}

// A file that a JSON scene names is read as one that is loaded, by the same folders.
TEST(Load, ReadsPicturesBelowTheAssetRoot) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "scenes");
  std::filesystem::create_directories(folder / "textures");
  folder.write("textures/a.png", "no picture");
  folder.write(
      "scenes/a.ply",
      "ply\nformat ascii 1.0\ncomment TextureFile ../textures/a.png\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nproperty float u\nproperty float v\nelement face 1\nproperty list "
      "uchar int "
      "vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 0 0\n0 1 0 0 0\n3 0 1 2\n");
  folder.write("scenes/a.json", R"({"objects": [{"type": "mesh", "file": "a.ply"}]})");
  for (const char* name : {"scenes/a.ply", "scenes/a.json"}) {
    const Scene without = load(folder / name),
                with = load(folder / name, {.asset_root = folder / "textures"});
    ASSERT_EQ(without.warnings.size(), 1u);
    EXPECT_NE(without.warnings[0].find("no picture '../textures/a.png'"), std::string::npos)
        << without.warnings[0];
    ASSERT_EQ(with.warnings.size(), 1u);
    EXPECT_NE(with.warnings[0].find("is neither PNG, JPEG nor WebP"), std::string::npos) << with.warnings[0];
  }
  EXPECT_THROW(load(folder / "scenes/a.ply", {.asset_root = folder / "none"}), Error);
}

// Under any name, and packed.
TEST(Load, SaysWhatStandsInPlaceOfAFile) {
  const ScratchFolder folder;
  const std::string pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n";
  for (const std::string name : {"a.glb", "a.obj", "a.stl", "a.ply.gz", "a.json", "a.nff"}) {
    const std::string file = (folder / name).string();
    EXPECT_EQ(refusal([&] { load(folder.write(name, pointer)); }),
              file +
                  ": is a Git LFS pointer, not the file that it stands for; run 'git lfs pull' where it "
                  "comes from, or "
                  "download the file itself");
    for (const std::string page : {"<!DOCTYPE html><p>", "\xef\xbb\xbf \n<HTML lang='en'>"})
      EXPECT_EQ(refusal([&] { load(folder.write(name, page)); }),
                file +
                    ": is a web page (HTML), not the file that its name says; download the file itself, not "
                    "the page "
                    "that shows it");
  }
  folder.write("p.png", pointer);
  folder.write("a.mtl", "newmtl a\nmap_Kd p.png\n");
  const Scene s = load(folder.write("b.obj", "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_NE(s.warnings[0].find("p.png: is a Git LFS pointer"), std::string::npos) << s.warnings[0];
}

TEST(Load, SaysWhichFormatsThereAre) {
  const ScratchFolder folder;
  const std::string message = refusal([&] { load(folder.write("a.doc", "")); });
  EXPECT_NE(message.find("unknown format '.doc'; known are .nff .obj .ply .stl .gltf .glb .json"),
            std::string::npos)
      << message;
  EXPECT_NE(refusal([&] { load(folder.write("noending", "")); }).find("no ending"), std::string::npos);
  EXPECT_NE(refusal([&] { load(folder / "none.nff"); }).find("none.nff: no such file"), std::string::npos);
}

// Every promise of scene.h, broken one at a time.
TEST(CheckScene, HoldsImportersToTheirPromises) {
  Scene good;
  good.name = "s";
  good.materials.emplace_back();
  good.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  good.triangles = {{.vertex = {0, 1, 2}}};
  good.normals = {vec3(0, 0, 1)};
  good.spheres = {{.center = dvec3(0), .radius = 1}};
  good.cones = {{.base = dvec3(0), .apex = dvec3(1), .base_radius = 1, .apex_radius = 0}};
  good.lights.emplace_back();
  good.camera = Camera{};
  EXPECT_NO_THROW(check_scene(good));

  const auto broken = [&](ErrorCode code, auto&& change) {
    Scene s = good;
    change(s);
    try {
      check_scene(s);
      ADD_FAILURE() << "accepted";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), code) << e.what();
    }
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const auto input = ErrorCode::input, internal = ErrorCode::internal;
  broken(input, [&](Scene& s) { s.vertices[1].y = nan; });
  broken(input, [&](Scene& s) { s.normals[0].x = static_cast<float>(inf); });
  broken(input, [&](Scene& s) { s.spheres[0].center.z = inf; });
  broken(input, [&](Scene& s) { s.spheres[0].radius = 0; });
  broken(input, [&](Scene& s) { s.cones[0].apex = s.cones[0].base; });
  broken(input, [&](Scene& s) { s.cones[0].base_radius = -1; });
  broken(input, [&](Scene& s) { s.materials[0].diffuse.x = static_cast<float>(nan); });
  broken(input, [&](Scene& s) { s.materials[0].index = 0; });
  broken(input, [&](Scene& s) { s.materials[0].shine = -1; });
  broken(input, [&](Scene& s) { s.lights[0].position.x = nan; });
  broken(input, [&](Scene& s) { s.lights[0].attenuation = dvec3(0); });
  broken(input,
         [&](Scene& s) { s.lights[0].kind = LightKind::spot, s.lights[0].direction = dvec3(2, 0, 0); });
  broken(input, [&](Scene& s) { s.lights[0].range = nan; });
  broken(input, [&](Scene& s) { s.camera->at = s.camera->from; });
  broken(input, [&](Scene& s) { s.camera->up = s.camera->from - s.camera->at; });
  broken(input, [&](Scene& s) { s.camera->vertical_fov = 4; });
  broken(input, [&](Scene& s) { s.background.x = -1; });
  broken(input, [&](Scene& s) { s.ambient.y = static_cast<float>(nan); });
  broken(internal, [&](Scene& s) { s.triangles[0].vertex[2] = 3; });
  broken(internal, [&](Scene& s) { s.triangles[0].normal[0] = 0; });
  broken(internal, [&](Scene& s) { s.triangles[0].material = 1; });
  broken(internal, [&](Scene& s) { s.spheres[0].material = 1; });
  broken(internal, [&](Scene& s) { s.materials.clear(); });
}

}  // namespace
}  // namespace kdray::scene
