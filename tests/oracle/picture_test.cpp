// What    The oracle's camera, its marking of edges and its counts.
#include <gtest/gtest.h>

#include <cmath>

#include "oracle/build_scene.h"
#include "oracle/oracle.h"

namespace kdray::oracle {
namespace {

TEST(EyeRay, SpansTheFieldOfView) {
  const scene::Camera camera{{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.0, 0};
  const auto slope = [&](double x, double y) {
    const dvec3 d = eye_ray(camera, x, y, 200, 100).direction;
    return glm::dvec2(d.x / -d.z, d.y / -d.z);
  };
  EXPECT_NEAR(slope(100, 0).y, std::tan(0.5), 1e-15);     // upper edge
  EXPECT_NEAR(slope(100, 100).y, -std::tan(0.5), 1e-15);  // lower edge
  EXPECT_NEAR(slope(200, 50).x, 2 * std::tan(0.5), 1e-15);
  EXPECT_NEAR(slope(100, 50).x, 0, 1e-15);
}

TEST(EyeRay, NothingIsSeenInFrontOfHither) {
  const scene::Camera camera{{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.0, 2.5};
  const Ray ray = eye_ray(camera, 10, 90, 100, 100);
  EXPECT_NEAR(-(ray.origin + ray.t_min * ray.direction).z, 2.5, 1e-14);
}

TEST(Picture, GridsAndOrientation) {
  // Four quadrants of light: red upper left, green upper right, blue lower left, white lower right.
  const SceneBuilder b = SceneBuilder()
                             .camera({0, 0, 5}, {0, 0, 0}, 2 * std::atan(0.2))
                             .quad({-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, glowing({1, 0, 0}))
                             .quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, glowing({0, 1, 0}))
                             .quad({-1, -1, 0}, {1, 0, 0}, {0, 1, 0}, glowing({0, 0, 1}))
                             .quad({0, -1, 0}, {1, 0, 0}, {0, 1, 0}, glowing({1, 1, 1}));
  const OracleResult centers = trace_picture(b.scene(), 2, 2, 5);
  EXPECT_EQ(centers.rgb[0], dvec3(1, 0, 0));
  EXPECT_EQ(centers.rgb[1], dvec3(0, 1, 0));
  EXPECT_EQ(centers.rgb[2], dvec3(0, 0, 1));
  EXPECT_EQ(centers.rgb[3], dvec3(1, 1, 1));
  EXPECT_EQ(centers.counts.primary_hit, 4u);
  // The outermost rays of the corner grid go through the picture's edges: here the quads' own.
  const OracleResult corners = trace_picture(b.scene(), 5, 5, 5, Grid::corners);
  EXPECT_EQ(corners.edge[0], 1);
  EXPECT_EQ(corners.rgb[6], dvec3(1, 0, 0));
  EXPECT_EQ(corners.rgb[8], dvec3(0, 1, 0));
}

TEST(Picture, EdgesAreMarkedAndNothingElse) {
  // A square whose left edge runs through the centres of one column of pixels.
  const double half = std::tan(0.25) * 5;  // half the height of the picture at distance 5
  const double x = -half + 2 * half * 4.5 / 16;
  const SceneBuilder b = SceneBuilder()
                             .camera({0, 0, 5}, {0, 0, 0}, 0.5)
                             .quad({x, -9, 0}, {18, 0, 0}, {0, 18, 0}, glowing(vec3(1)));
  const OracleResult r = trace_picture(b.scene(), 16, 16, 5);
  int edges = 0;
  for (int row = 0; row < 16; ++row) {
    EXPECT_EQ(r.edge[row * 16 + 4], 1) << row;
    EXPECT_EQ(r.spread[row * 16 + 4], 1) << row;
    for (int column = 0; column < 16; ++column) edges += r.edge[row * 16 + column];
  }
  EXPECT_LE(edges, 2 * 16);  // the column and, at most, the square's diagonal
}

TEST(Picture, CountsAddUp) {
  const SceneBuilder b = SceneBuilder()
                             .camera({0, 0, 5}, {0, 0, 0}, 2.0)
                             .sphere({0, 0, 0}, 1, mirror(vec3(0.5f)))
                             .light({0, 0, 9});
  const OracleResult r = trace_picture(b.scene(), 33, 17, 5);
  EXPECT_EQ(r.counts.primary, 33u * 17);
  EXPECT_GT(r.counts.primary_hit, 0u);
  EXPECT_EQ(r.counts.reflected, r.counts.primary_hit);  // every reflection of a lone sphere leaves
  EXPECT_EQ(r.counts.shadow, 0u);                       // a mirror alone shows no light
  EXPECT_EQ(r.counts.refracted, 0u);
}

}  // namespace
}  // namespace kdray::oracle
