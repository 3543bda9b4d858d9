// Smooth balls of few triangles: no black pixel where the interpolated normal faces the light, and no step of
// colour where two triangles share an edge.
#include <gtest/gtest.h>

#include <cmath>

#include "oracle/build_scene.h"
#include "pictures/render.h"
#include "pictures/scenes.h"
#include "stress/random.h"
#include "stress/table.h"
#include "stress/traced.h"

namespace kdray::stress {
namespace {

constexpr std::uint64_t kSeed = 66000;
constexpr int kSize = 384;
constexpr double kPixel = 0.006;    // a pixel's width on the ball, in radii
constexpr double kLargestTurn = 3;  // of normals, in rad per radius along the surface

class Shading : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    if (devices().empty()) GTEST_SKIP() << "no OpenCL device";
  }

  // A ball of `rows` rows in the light of a far lamp from `to_light`.
  static Picture picture_of(int rows, const dvec3& to_light, Traversal traversal) {
    oracle::SceneBuilder b;
    scene::Light lamp;
    lamp.kind = scene::LightKind::directional;
    lamp.direction = -to_light;
    b.light(lamp).camera({0, 0, 5}, {0, 0, 0}, 0.45);
    scene::Scene model = b.scene();
    test::add_smooth_ball(model, dvec3(0), 1, rows, oracle::matte(vec3(1)));
    Renderer renderer{Scene{std::move(model)}};
    RenderOptions options = test::exact_options(kSize, kSize, 1);
    options.channels = {"normal", "depth"};
    options.traversal = traversal;
    return renderer.render(options);
  }
};

TEST_P(Shading, NoBlackTerminatorAndNoSteps) {
  const int rows = GetParam();
  Tally black("shading", "black pixels, " + std::to_string(rows) + " rows");
  Tally steps("shading", "steps of colour, " + std::to_string(rows) + " rows");
  for (std::uint64_t i = 0; i < (is_full() ? 24 : 2); ++i) {
    Random random(kSeed, i);
    // The light comes from the side, where the terminator is seen.
    const dvec3 to_light = glm::normalize(random.direction() * dvec3(1, 1, 0.4));
    for (std::size_t w = 0; w < kWalks.size(); ++w) {
      const Picture p = picture_of(rows, to_light, kWalks[w].traversal);
      const auto& nx = test::channel(p, "normal.x");
      const auto& ny = test::channel(p, "normal.y");
      const auto& nz = test::channel(p, "normal.z");
      const auto& depth = test::channel(p, "depth");
      const auto normal = [&](std::size_t at) { return dvec3(nx[at], ny[at], nz[at]); };
      const auto on_ball = [&](std::size_t at) { return glm::length(normal(at)) > 0.5 && nz[at] > 0.35; };
      for (std::size_t at = 0; at + 1 < nx.size(); ++at) {
        if (!on_ball(at)) continue;
        const double wanted = std::max(0.0, glm::dot(normal(at), to_light)), found = p.rgb[3 * at];
        ++black.row(w).rays;
        black.row(w).wrong += wanted > 0.01 && std::abs(found - wanted) > 0.05 * wanted + 1e-4;
        if (at % kSize + 1 == kSize || !on_ball(at + 1)) continue;
        ++steps.row(w).rays;
        // Neighbours lie far apart on a triangle that is seen nearly edge-on: there colours may change
        // quickly.
        const double apart = std::hypot(kPixel, depth[at + 1] - depth[at]);
        steps.row(w).wrong += std::abs(p.rgb[3 * at + 3] - found) > std::max(0.05, kLargestTurn * apart);
      }
    }
  }
  black.publish();
  steps.publish();
  EXPECT_GT(black.row(0).rays, 10000);
  EXPECT_EQ(black.wrong(), 0) << "seed " << kSeed;
  EXPECT_EQ(steps.wrong(), 0) << "seed " << kSeed;
}

INSTANTIATE_TEST_SUITE_P(Rows, Shading, testing::Values(4, 6, 10, 16));

}  // namespace
}  // namespace kdray::stress
