// What    kdray verify: words, figures, picture and exit code, on meshes whose faults are known.
#include <nlohmann/json.hpp>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "io/image/picture_file.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// A cube's corners, and its sides as quads, counter-clockwise from outside.
constexpr const char* kCorners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
constexpr const char* kFiveSides = "f 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
constexpr const char* kBottom = "f 1 4 3 2\n";

std::string cube() {
  std::string text = kCorners;
  return text.append(kFiveSides).append(kBottom);
}

Outcome verify(const fs::path& scene, std::vector<std::string> more = {}) {
  more.insert(more.begin(), {"verify", scene.string(), "--rays", "4000"});
  return kdray(more);
}

bool says(const Outcome& run, const std::string& text) {
  return run.err.find(text) != std::string::npos;
}

TEST(VerifyCommand, ASoundCube) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const Outcome run = verify(folder.put("cube.obj", cube()), {"--stats", "-"});
  ASSERT_TRUE(succeeds(run));
  for (const char* const text :
       {"12 triangles", "8 points, 18 edges", "1, 1 of them watertight", "[ok]   open edges", "[ok]   leaks",
        "traces this scene soundly, and its mesh is sound"})
    EXPECT_TRUE(says(run, text)) << text << " in " << run.err;
  EXPECT_FALSE(says(run, "[bad]")) << run.err;
  const Json found = Json::parse(run.out);
  EXPECT_EQ(found["mesh"]["sound"], true);
  EXPECT_EQ(found["mesh"]["components"]["closed"], 1);
  EXPECT_EQ(found["tracing"]["sound"], true);
  EXPECT_EQ(
      found["tracing"]["rays_from_inside"].get<int>() + found["tracing"]["rays_from_outside"].get<int>(),
      4000);
  EXPECT_EQ(found["tracing"]["leaks"], 0);
}

TEST(VerifyCommand, AMissingSideIsANoteAndNoError) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const Outcome run = verify(folder.put("open.obj", std::string(kCorners) + kFiveSides), {"--stats", "-"});
  ASSERT_TRUE(succeeds(run));
  EXPECT_TRUE(says(run, "[note] open edges        4, in 1 piece:")) << run.err;
  EXPECT_TRUE(says(run, "nothing is watertight")) << run.err;
  EXPECT_TRUE(says(run, "but see the notes on its mesh")) << run.err;
  const Json found = Json::parse(run.out);
  EXPECT_EQ(found["mesh"]["open_edges"]["count"], 4);
  EXPECT_EQ(found["mesh"]["open_edges"]["some"].size(), 4u);
  for (const Json& edge : found["mesh"]["open_edges"]["some"]) {
    EXPECT_EQ(edge["from"][2], 0.0);
    EXPECT_EQ(edge["to"][2], 0.0);
  }
}

TEST(VerifyCommand, FlippedAndDoubledFacesByTheirNumbers) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene =
      folder.put("faults.obj", std::string(kCorners) + kFiveSides + "f 1 2 3\nf 1 4 3\nf 6 7 5\n");
  const Outcome run = verify(scene, {"--stats", "-"});
  ASSERT_TRUE(succeeds(run));
  const Json mesh = Json::parse(run.out)["mesh"];
  EXPECT_EQ(mesh["flipped_faces"]["some"], Json::array({10}));
  EXPECT_EQ(mesh["doubled_faces"]["some"], Json::array({12}));
  EXPECT_TRUE(says(run, "[note] flipped faces     1, by")) << run.err;
  EXPECT_TRUE(says(run, "[note] doubled faces     1 whose")) << run.err;
}

// A side has a corner more on the edge to the bottom; a triangle without area is in between, another has two
// corners in one.
TEST(VerifyCommand, ZeroAreaClosesAndIsCounted) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene =
      folder.put("divided.obj", std::string(kCorners) +
                                    "v 0.5 0 0\nf 5 6 7 8\nf 1 9 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n" +
                                    kBottom + "f 1 2 9\nf 9 9 2\n");
  const Outcome run = verify(scene, {"--stats", "-"});
  ASSERT_TRUE(succeeds(run));
  EXPECT_TRUE(says(run, "1, 1 of them watertight")) << run.err;
  EXPECT_TRUE(says(run, "1 triangle without area")) << run.err;
  EXPECT_TRUE(says(run, "[note] degenerate        1 with corners in one place")) << run.err;
  const Json mesh = Json::parse(run.out)["mesh"];
  EXPECT_EQ(mesh["stitches"], 1);
  EXPECT_EQ(mesh["dropped_degenerate"], 1);
  EXPECT_EQ(mesh["open_edges"]["count"], 0);
  const Json info = Json::parse(kdray({"info", scene.string(), "--json"}).out)["primitives"];
  EXPECT_EQ(info["stitches"], 1);
  EXPECT_EQ(info["dropped_degenerate"], 1);
  EXPECT_EQ(info["triangles"], 15);
  EXPECT_NE(
      kdray({"info", scene.string()}).out.find("; 1 of the triangles without area; 1 degenerate dropped"),
      std::string::npos);
}

TEST(VerifyCommand, SpheresConesAndNothing) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const Outcome balls = verify(folder.put("ball.nff", kSphereOnSquare));
  ASSERT_TRUE(succeeds(balls));
  EXPECT_TRUE(says(balls, "2 triangles, 1 spheres")) << balls.err;
  const Outcome none = verify(folder.put("none.json", "{\"objects\": []}"));
  if (none.code == 0) {
    EXPECT_TRUE(says(none, "nothing to hit")) << none.err;
  } else {
    EXPECT_TRUE(fails_with(none, 1, "none.json"));
  }
}

TEST(VerifyCommand, WritesAPictureOfItsSize) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path picture = folder / "where.png";
  const Outcome run = verify(folder.put("open.obj", std::string(kCorners) + kFiveSides),
                             {"-o", picture, "--size", "400x300"});
  ASSERT_TRUE(succeeds(run));
  EXPECT_NE(run.err.find("where.png; red: open edges\n"), std::string::npos) << run.err;
  const image::Image image = image::read_picture(picture, {});
  EXPECT_EQ(image.width, 400);
  EXPECT_EQ(image.height, 300);
  int red = 0;
  for (const vec3& p : image.pixels) red += p.x > 0.6f && p.y < 0.1f && p.z < 0.1f;
  EXPECT_GT(red, 100);  // the open edges
}

TEST(VerifyCommand, QuietSaysNothingOfASoundScene) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const Outcome run = verify(folder.put("open.obj", std::string(kCorners) + kFiveSides), {"--quiet"});
  EXPECT_TRUE(succeeds(run));
  EXPECT_EQ(run.err + run.out, "");
}

TEST(VerifyCommand, BadInputIsToldInOneLine) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("cube.obj", cube());
  EXPECT_TRUE(fails_with(verify(folder / "no.obj"), 1, "no.obj"));
  EXPECT_TRUE(fails_with(verify(folder.put("bad.obj", "v 1 x 2\n")), 1, "bad.obj"));
  EXPECT_TRUE(fails_with(verify(scene, {"-o", "where.gif"}), 1, "where.gif"));
  EXPECT_TRUE(fails_with(verify(scene, {"-o", folder / "a.png", "--size", "20x20"}), 2, "320x200"));
  EXPECT_TRUE(fails_with(verify(scene, {"--stats", scene}), 2, "same file"));
  EXPECT_TRUE(fails_with(kdray({"verify", scene, "--rays", "0"}), 2, "--rays"));
}

}  // namespace
}  // namespace kdray::test
