// What    The blur of an edge seen through a thin lens, against the share of the lens from which it is seen:
//         a segment of a circle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "oracle/build_scene.h"
#include "pictures/render.h"

namespace kdray::test {
namespace {

constexpr int kWidth = 40, kHeight = 6;
constexpr double kAperture = 0.5, kFocus = 4;

// A sheet that shines, from x = 0 on, so far before the camera.
scene::Scene edge_at(double distance, bool parallel) {
  oracle::SceneBuilder b;
  b.quad({0, -200, -distance}, {200, 0, 0}, {0, 400, 0}, oracle::glowing(vec3(1)));
  scene::Scene s = b.scene();
  s.unlit = true;
  s.camera = scene::Camera{.from = {0, 0, 0},
                           .at = {0, 0, -1},
                           .up = {0, 1, 0},
                           .vertical_fov = 2 * std::atan(0.5 * kHeight / kWidth),
                           .ortho_width = parallel ? 4.0 : 0.0,
                           .aperture = kAperture,
                           .focus = kFocus};
  return s;
}

// The share of a disc of radius 1 on that side of a chord where x > -c.
double segment(double c) {
  const double x = std::clamp(c, -1.0, 1.0);
  return 0.5 + (x * std::sqrt(1 - x * x) + std::asin(x)) / std::numbers::pi;
}

// Where a pinhole's ray at `sx`, from -1/2 to 1/2 of the picture, meets the plane in focus; from there a ray
// from the lens at u meets the sheet's plane at focus*d/f + u*(1 - d/f).
double wanted(double sx, double distance, bool parallel) {
  const double in_focus = parallel ? 4 * sx : sx * kFocus, far = distance / kFocus;
  const double middle = parallel ? in_focus : in_focus * far;
  const double spread = kAperture / 2 * (1 - far);
  if (std::abs(spread) < 1e-12) return middle > 0 ? 1 : 0;
  return segment(middle / std::abs(spread));
}

TEST(Lens, AnEdgeIsBlurredByItsDistanceFromTheFocus) {
  for (const bool parallel : {false, true})
    for (const double distance : {1.5, 3.0, 4.0, 9.0, 40.0}) {
      Renderer renderer(Scene{edge_at(distance, parallel)}, {}, device_of());
      RenderOptions options = exact_options(kWidth, kHeight, 1);
      options.samples = 1024;
      const Picture picture = renderer.render(options);
      for (int x = 0; x < kWidth; ++x) {
        double mean = 0;
        for (int i = 0; i < 256; ++i)
          mean += wanted((x + (i + 0.5) / 256) / kWidth - 0.5, distance, parallel) / 256;
        for (int y = 0; y < kHeight; ++y)
          ASSERT_NEAR(picture.rgb[static_cast<std::size_t>(3 * (y * kWidth + x))], mean, 0.012)
              << x << " at " << distance << (parallel ? ", parallel" : "");
      }
    }
}

TEST(Lens, WithoutAFocusThatOfWhatItLooksAt) {
  scene::Scene given = edge_at(9, false), left_out = given;
  given.camera->at = {0, 0, -kFocus}, left_out.camera->at = {0, 0, -kFocus};
  left_out.camera->focus = 0;
  RenderOptions options = exact_options(kWidth, kHeight, 1);
  options.samples = 4;
  EXPECT_TRUE(same_bits(Renderer(Scene{std::move(given)}, {}, device_of()).render(options).rgb,
                        Renderer(Scene{std::move(left_out)}, {}, device_of()).render(options).rgb));
}

// A lens of the camera that a program asks for, in place of the scene's own, which has none.
TEST(Lens, ThatOfACameraGivenWithThePicture) {
  const scene::Scene with = edge_at(9, false);
  scene::Scene without = with;
  without.camera->aperture = without.camera->focus = 0;
  RenderOptions options = exact_options(kWidth, kHeight, 1);
  options.samples = 64;
  const auto rendered = [&](const scene::Scene& s) {
    return Renderer(Scene{scene::Scene(s)}, {}, device_of()).render(options).rgb;
  };
  const std::vector<float> wanted = rendered(with), sharp = rendered(without);
  ASSERT_NE(wanted, sharp);
  options.camera = Camera{.from = {0, 0, 0},
                          .at = {0, 0, -1},
                          .up = {0, 1, 0},
                          .fov = 2 * std::atan(0.5 * kHeight / kWidth) * 180 / std::numbers::pi,
                          .aperture = kAperture,
                          .focus = kFocus};
  const std::vector<float> given = rendered(without);
  ASSERT_EQ(given.size(), wanted.size());
  for (std::size_t i = 0; i < given.size(); ++i) EXPECT_NEAR(given[i], wanted[i], 1e-6) << i;
  options.camera->aperture = 0;
  EXPECT_EQ(rendered(with), rendered(without));
}

TEST(Lens, AViewGivesOneAndTakesItAway) {
  const Scene scene{edge_at(9, false)};
  const PreparedScene prepared{scene};
  RenderOptions options = exact_options(kWidth, kHeight, 1);
  options.samples = 4;
  scene::Scene pinhole = edge_at(9, false);
  pinhole.camera->aperture = 0;
  const Picture without = Renderer(Scene{std::move(pinhole)}, {}, device_of()).render(options);
  EXPECT_TRUE(
      same_bits(without.rgb, Renderer(prepared.seen({.aperture = 0.0}), device_of()).render(options).rgb));
  const Picture with = Renderer(prepared, device_of()).render(options);
  EXPECT_FALSE(same_bits(without.rgb, with.rgb));
  EXPECT_TRUE(same_bits(
      with.rgb,
      Renderer(prepared.seen({.aperture = kAperture, .focus = kFocus}), device_of()).render(options).rgb));
}

}  // namespace
}  // namespace kdray::test
