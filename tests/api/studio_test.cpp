// A scene in a studio through the public interface; and its floor against closed forms in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "accel/prepare/prepared.h"
#include "kdray/kdray.h"
#include "scene/model/frame.h"
#include "scene/model/scene.h"
#include "support/device.h"

namespace kdray {
namespace {

const dvec3 kBall(0, 1.5, 0);  // of radius 1
const vec3 kShine(0.2f, 0.4f, 0.6f), kLight(0.7f, 0.6f, 0.5f), kBehind(0.25f, 0.3f, 0.35f);

scene::Scene ball_over_floor() {
  scene::Scene s;
  s.spheres = {{.center = kBall, .radius = 1, .material = 1},
               {.center = {0, 300, 0}, .radius = 0.01, .number = 1}};
  // The first material is that of what isn't seen: the floor must have nothing of it.
  s.materials = {{.specular = vec3(0.5f), .transmit = vec3(0.5f), .shine = 3}, {.emission = kShine}};
  s.lights = {{.kind = scene::LightKind::directional,
               .direction = glm::normalize(dvec3(0.3, -1, -0.2)),
               .color = kLight}};
  s.background = kBehind;
  s.camera = scene::Camera{.from = {3, 4, 6}, .at = {0, 1, 0}, .vertical_fov = 0.9};
  s.framing.floor = {.middle = {0.5, 0, 0},
                     .inner = 2,
                     .radius = 5,
                     .unshadowed = vec3(0.05f, 0.1f, 0.15f),
                     .diffuse = vec3(0.5f, 0.4f, 0.3f),
                     .reflect = 0.3f};
  return s;
}

// How surely a ray meets the ball: above 0 if it does; near 0 it grazes.
double meets_ball(const dvec3& from, const dvec3& way) {
  const dvec3 to = kBall - from;
  const double along = glm::dot(to, way);
  return along > 0 ? 1 - glm::dot(to, to) + along * along : -1;
}

// What a ray sees; none where it grazes the ball, or another that it depends on does.
std::optional<dvec3> seen(const scene::Scene& s, const dvec3& from, const dvec3& way) {
  constexpr double kGrazes = 1e-3;
  const double direct = meets_ball(from, way);
  if (std::abs(direct) < kGrazes) return std::nullopt;
  if (direct > 0) return dvec3(kShine);
  const scene::Floor& floor = s.framing.floor;
  if (way.y >= 0) return dvec3(kBehind);
  const dvec3 p = from - way * (from.y / way.y);
  const double r = glm::distance(p, floor.middle);
  if (r >= floor.radius) return dvec3(kBehind);
  const double x = std::clamp((floor.radius - r) / (floor.radius - floor.inner), 0.0, 1.0);
  const double share = x * x * (3 - 2 * x);
  const dvec3 to_light = -s.lights[0].direction, mirrored(way.x, -way.y, way.z);
  const double shadow = meets_ball(p, to_light), mirror = meets_ball(p, mirrored);
  if (std::abs(shadow) < kGrazes || std::abs(mirror) < kGrazes) return std::nullopt;
  const dvec3 lit = shadow > 0 ? dvec3(0) : dvec3(floor.diffuse) * dvec3(kLight) * to_light.y;
  return share *
             (dvec3(floor.unshadowed) + lit + double{floor.reflect} * dvec3(mirror > 0 ? kShine : kBehind)) +
         (1 - share) * dvec3(kBehind);
}

class StudioTest : public test::EachDevice {
 protected:
  DeviceOptions device() const {
    DeviceOptions options;
    options.device = GetParam();
    return options;
  }
};

KDRAY_FOR_EACH_DEVICE(StudioTest);

TEST_P(StudioTest, TheFloorIsLitAndShadowedAndMirrorsAndFades) {
  const scene::Scene s = ball_over_floor();
  Renderer renderer(PreparedScene(prepare::prepare(s, {})), device());
  constexpr int kSide = 96;
  const Picture picture = renderer.render({.width = kSide, .height = kSide, .min_weight = 0});
  const scene::Basis view = scene::basis_of(*s.camera);
  const double half = std::tan(s.camera->vertical_fov / 2);
  int compared = 0, faded = 0;
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column) {
      const double x = (2 * (column + 0.5) / kSide - 1) * half, y = (1 - 2 * (row + 0.5) / kSide) * half;
      const std::optional<dvec3> wanted =
          seen(s, s.camera->from, glm::normalize(view.forward + x * view.right + y * view.up));
      if (!wanted) continue;
      ++compared, faded += *wanted != dvec3(kBehind) ? 1 : 0;
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(picture.rgb[static_cast<std::size_t>(3 * (row * kSide + column) + c)], (*wanted)[c], 2e-5)
            << column << ", " << row;
    }
  EXPECT_GT(compared, 9 * kSide * kSide / 10);
  EXPECT_GT(faded, kSide * kSide / 3);
}

// Under the floor there is none, and no channel tells of it.
TEST_P(StudioTest, TheFloorIsSeenFromAboveAlone) {
  scene::Scene s = ball_over_floor();
  s.camera->from = {3, -4, 6};
  Renderer renderer(PreparedScene(prepare::prepare(s, {})), device());
  const Picture picture = renderer.render({.width = 32, .height = 32, .channels = {"primitive"}});
  for (std::size_t i = 0; i < 32 * 32; ++i) {
    const float red = picture.rgb[3 * i];
    EXPECT_EQ(red, picture.channels[0].values[i] < 0 ? kBehind.x : kShine.x) << i;
  }
}

TEST_P(StudioTest, APictureInAStudioLeavesOthersAsTheyWere) {
  const std::vector<double> corners = {0, 0, 0, 2, 0, 0, 0, 3, 0};
  const std::vector<std::uint32_t> triangle = {0, 1, 2};
  Scene scene;
  scene.add_mesh({corners, triangle});
  scene.commit({.device = device()});
  const RenderOptions options{.width = 40, .height = 30};
  const Picture plain = scene.render(options), studio = scene.render(options, Look::studio);
  EXPECT_NE(plain.rgb, studio.rgb);
  EXPECT_EQ(scene.render(options).rgb, plain.rgb);
  EXPECT_EQ(scene.render(options, Look::studio).rgb, studio.rgb);
  EXPECT_EQ(*std::ranges::min_element(plain.rgb), 0) << "black behind it";
  EXPECT_GT(*std::ranges::min_element(studio.rgb), 0.02f) << "a backdrop all around";
  scene.add_light({.position = {0, 0, 9}});
  scene.commit({.device = device()});
  EXPECT_EQ(scene.render(options, Look::studio).rgb, scene.render(options).rgb) << "it has lights of its own";
}

}  // namespace
}  // namespace kdray
