// What    The command for a request, eye rays, and the cells of a tree, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include <nlohmann/json.hpp>

#include "accel/prepare/prepared.h"
#include "apps/view/facts.h"
#include "apps/view/pick.h"
#include "apps/view/scene_renderer.h"
#include "apps/view/view_request.h"
#include "scene/model/frame.h"
#include "scene/model/scene.h"
#include "support/folder.h"

namespace kdray::view {
namespace {

TEST(Command, HasTheNumbersWithAllTheirBits) {
  ViewRequest request;
  request.camera = {.from = {0.1, 1.0 / 3, -2e-7}, .at = {0, 0, 0}, .up = {0, 0, 1}, .fov = 33.3};
  request.width = 64, request.height = 48;
  request.samples = Samples::adaptive;
  EXPECT_EQ(
      command_for(request, {}, "a b's.nff"),
      "kdray render 'a b'\\''s.nff' --from=0.1,0.3333333333333333,-2e-07 --at=0,0,0 --up=0,0,1 --fov 33.3 "
      "--size 64x48 --samples adaptive");
  request.camera.ortho_width = 2.5;
  request.channel = "depth";
  request.headlight = 0.5;
  request.mode = Mode::odprt;
  request.queues = 2;
  request.look = kdray::Look::plain;
  Settings settings;
  settings.load.smooth_degrees = 40;
  settings.load.asset_root = "my textures";
  settings.view.camera = 1;
  EXPECT_EQ(
      command_for(request, settings, "-x.nff"),
      "kdray render './-x.nff' --smooth 40 --asset-root 'my textures' --look plain "
      "--from=0.1,0.3333333333333333,-2e-07 "
      "--at=0,0,0 --up=0,0,1 "
      "--camera 1 --ortho 2.5 --headlight 0.5 --size 64x48 --depth 1 --samples 1 --queues 2 --mode odprt "
      "--aov depth");
  settings.studio_instead = true;  // as long as the page shows it
  EXPECT_EQ(command_for(request, settings, "a.nff").find("--look studio"), std::string::npos);
  request.look.reset();
  EXPECT_NE(command_for(request, settings, "a.nff").find(" --look studio --from="), std::string::npos);
  settings.studio_instead = false;
  EXPECT_EQ(command_for(request, settings, "a.nff").find("--look"), std::string::npos);
  request.look = kdray::Look::studio;  // chosen on the page
  EXPECT_NE(command_for(request, settings, "a.nff").find(" --look studio --from="), std::string::npos);
}

TEST(EyeRay, GoesThroughThePicturesEdges) {
  const Camera camera{.from = {0, 0, 5}, .at = {0, 0, 0}, .up = {0, 1, 0}, .fov = 90};
  const EyeRay middle = eye_ray(camera, 2, 0.5, 0.5);
  EXPECT_EQ(middle.origin, camera.from);
  EXPECT_EQ(middle.direction, (Vec3{0, 0, -1}));
  const EyeRay corner = eye_ray(camera, 2, 1, 0);  // right, top: tan 45 degrees up, twice that to the right
  EXPECT_NEAR(corner.direction[0] / -corner.direction[2], 2, 1e-12);
  EXPECT_NEAR(corner.direction[1] / -corner.direction[2], 1, 1e-12);
  Camera parallel = camera;
  parallel.ortho_width = 8;
  const EyeRay left = eye_ray(parallel, 2, 0, 0.5);
  EXPECT_NEAR(left.origin[0], -4, 1e-12);
  EXPECT_EQ(left.direction, (Vec3{0, 0, -1}));
}

TEST(Cells, FillTheBoundsAndDontOverlap) {
  const test::Folder folder;
  const Scene scene = Scene::load(std::string(KDRAY_SOURCE_DIR) + "/scenes/balls.nff");
  const PreparedScene prepared(scene);
  const auto volume = [](const DBox& b) { return b.extent().x * b.extent().y * b.extent().z; };
  const std::vector<DBox> whole = cells_of(prepared.prepared(), 0);
  ASSERT_EQ(whole.size(), 1u);
  for (const int depth : {1, 2, 5, 8, 24}) {
    const std::vector<DBox> cells = cells_of(prepared.prepared(), depth);
    EXPECT_LE(cells.size(), kMostCells);
    EXPECT_GE(cells.size(), depth > 4 ? 8u : 2u);
    double sum = 0;
    for (const DBox& cell : cells) {
      EXPECT_TRUE(whole[0].contains(cell));
      sum += volume(cell);
    }
    EXPECT_NEAR(sum, volume(whole[0]), 1e-6 * volume(whole[0])) << depth;
  }
}

TEST(SceneRenderer, MakesTheStudioAtMostOnce) {
  const test::Folder folder;
  const PreparedScene plain(Scene::load(folder.put("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")), {});
  const PreparedScene studio = plain.in_studio();
  Settings in_plain;
  in_plain.look = kdray::Look::plain;
  const SceneRenderer given({plain, {}, studio}, {}), making({plain, {}}, in_plain);
  EXPECT_EQ(&given.scene().prepared(), &studio.prepared()) << "what is there is not made again";
  EXPECT_EQ(&given.scene({kdray::Look::plain}).prepared(), &plain.prepared());
  EXPECT_EQ(&making.scene().prepared(), &plain.prepared());
  const PreparedScene& made = making.scene({kdray::Look::studio});
  EXPECT_TRUE(made.settings().framing.studio);
  EXPECT_EQ(&made, &making.scene({kdray::Look::studio}));
}

TEST(SceneMessage, AWidthAloneIsASizeOfTheScenesAspectRatio) {
  const test::Folder folder;
  const PreparedScene scene(Scene::load(std::string(KDRAY_SOURCE_DIR) + "/scenes/balls.nff"), {});
  const scene::RenderSettings asked = scene::settings_of(scene.settings());
  Settings settings;
  settings.render.width = 64;
  const SceneRenderer renderer({scene, {}}, settings);
  const auto message = nlohmann::json::parse(scene_message({}, 0, renderer, false));
  EXPECT_EQ(message["size"], (nlohmann::json{64, 64 * *asked.height / *asked.width}));
}

}  // namespace
}  // namespace kdray::view
