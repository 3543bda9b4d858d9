// Settings, the bound on radiance, and the camera.
#include "accel/flatten/frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include "kdray/error.h"

namespace kdray::flatten {
namespace {

TEST(Resolved, OptionsWinOverTheSceneAndTheSceneOverDefaults) {
  scene::RenderSettings settings;
  EXPECT_EQ(resolved({}, settings).width, 1024);
  EXPECT_EQ(resolved({}, settings).depth, 5);
  settings.width = 320;
  settings.depth = 3;
  settings.min_weight = 0.25;
  EXPECT_EQ(resolved({}, settings).width, 320);
  EXPECT_EQ(resolved({}, settings).min_weight, 0.25);
  RenderOptions options;
  options.width = 64;
  options.depth = 9;
  options.min_weight = 0;
  EXPECT_EQ(resolved(options, settings).width, 64);
  EXPECT_EQ(resolved(options, settings).depth, 9);
  EXPECT_EQ(resolved(options, settings).min_weight, 0);
}

TEST(Resolved, RefusesWhatCannotBe) {
  RenderOptions deep;
  deep.depth = 65;
  EXPECT_THROW((void)resolved(deep, {}), Error);
  for (const PixelRect part :
       {PixelRect{0, 0, 65, 1}, PixelRect{60, 0, 5, 48}, PixelRect{0, 48, 1, 1}, PixelRect{-1, 0, 2, 2},
        PixelRect{3, 3, 0, 4}, PixelRect{9, 9, 2147483647, 1}}) {
    const RenderOptions cropped{.width = 64, .height = 48, .crop = part};
    EXPECT_THROW((void)resolved(cropped, {}), Error) << in_words(part);
  }
  EXPECT_NO_THROW((void)resolved({.width = 64, .height = 48, .crop = PixelRect{0, 0, 64, 48}}, {}));
  for (const RenderOptions& wrong :
       {RenderOptions{.width = -1}, RenderOptions{.depth = -2}, RenderOptions{.samples = -7},
        RenderOptions{.min_weight = std::nan("")}, RenderOptions{.adaptive_target = std::nan("")}})
    EXPECT_THROW((void)resolved(wrong, {}), Error);
  RenderOptions huge;
  huge.width = huge.height = 65536;
  EXPECT_THROW((void)resolved(huge, {}), Error);
}

TEST(RadianceBound, IsTheGeometricSumOverDepths) {
  scene::Scene s;
  s.materials = {{.diffuse = vec3(0.5f), .specular = vec3(0.25f), .reflect = vec3(0.5f)}};
  s.lights = {scene::Light{.color = vec3(2)}};
  EXPECT_DOUBLE_EQ(radiance_bound(s, 1), 1.5);
  EXPECT_DOUBLE_EQ(radiance_bound(s, 3), 1.5 * 1.75);
  s.lights[0].attenuation = vec3(0, 0, 1);
  EXPECT_TRUE(std::isinf(radiance_bound(s, 1)));
  // A black light adds nothing, and a material that no light changes keeps its emission.
  s.lights[0].color = vec3(0);
  s.materials.push_back({.emission = vec3(100)});
  EXPECT_DOUBLE_EQ(radiance_bound(s, 1), 100);
  s.lights[0].color = vec3(1);
  s.materials.erase(s.materials.begin());
  EXPECT_DOUBLE_EQ(radiance_bound(s, 1), 100);
}

TEST(MakeFrame, CornersReachTheEdgesAndCentresDoNot) {
  scene::Scene s;
  s.camera =
      scene::Camera{.from = {0, 0, 1}, .at = {0, 0, 0}, .up = {0, 1, 0}, .vertical_fov = std::acos(-1.0) / 2};
  RenderOptions options;
  options.width = 5;
  options.height = 3;
  const scene::Geometry g = scene::make_geometry(s);
  options.grid = PixelGrid::corners;
  const layout::Frame corners = make_frame(s, g, resolved(options, {}));
  EXPECT_NEAR(corners.y_offset, 1.0f, 1e-6f);
  EXPECT_NEAR(2 * corners.y_scale + corners.y_offset, -1.0f, 1e-6f);
  EXPECT_NEAR(4 * corners.x_scale + corners.x_offset, 5.0f / 3, 1e-6f);
  options.grid = PixelGrid::centers;
  const layout::Frame centers = make_frame(s, g, resolved(options, {}));
  EXPECT_NEAR(5 * centers.x_scale + centers.x_offset, 5.0f / 3, 1e-6f);
  EXPECT_EQ(centers.forward[2], -1.0f);
  EXPECT_EQ(centers.right[0], 1.0f);
}

}  // namespace
}  // namespace kdray::flatten
