// What    kdray's own reader takes what the generators write, without a warning and with nothing lost.
#include <gtest/gtest.h>

#include "nff_lines.h"
#include "scene/import/load.h"
#include "scene/model/geometry.h"

namespace kdray::generate {
namespace {

scene::Scene loaded(std::string_view name, int size) {
  return scene::read_nff(test::generated(name, size), std::string(name) + ".nff");
}

TEST(Load, TakesEveryGeneratorsSmallScenes) {
  for (const Generator& g : generators()) {
    SCOPED_TRACE(g.name);
    const int size = std::min(g.min_size + 1, g.max_size);
    const test::Nff nff = test::parse_nff(test::generated(g.name, size));
    const scene::Scene s = loaded(g.name, size);
    EXPECT_TRUE(s.warnings.empty()) << s.warnings.front();
    EXPECT_TRUE(s.camera.has_value());
    EXPECT_EQ(s.lights.size(), static_cast<std::size_t>(nff.lights));
    EXPECT_EQ(s.spheres.size(), nff.spheres.size());
    EXPECT_EQ(s.cones.size(), nff.cones.size());
    std::size_t triangles = 0;
    for (const test::NffPolygon& p : nff.polygons) triangles += p.vertices.size() - 2;
    EXPECT_EQ(s.triangles.size(), triangles + nff.patches.size());
    EXPECT_EQ(scene::make_geometry(s).dropped_degenerate, 0u);
  }
}

TEST(Load, CutsGearFacesWithoutOverlap) {
  const scene::Scene s = loaded("gears", 1);
  ASSERT_EQ(s.triangles.size(), 2u + 2 * 142 + 144 * 2);
  // A face's triangles all turn the same way and together have the face's area: none lies outside.
  double area = 0, turned = 0;
  for (std::size_t i = 2; i < 2 + 142; ++i) {
    const auto& t = s.triangles[i];
    const dvec3 a = s.vertices[t.vertex[0]], b = s.vertices[t.vertex[1]], c = s.vertices[t.vertex[2]];
    const double twice = glm::cross(b - a, c - a).z;
    area += std::abs(twice) / 2;
    turned += twice / 2;
  }
  double shoelace = 0;
  const test::Nff nff = test::parse_nff(test::generated("gears", 1));
  const auto& face = nff.polygons[1].vertices;
  for (std::size_t i = 0; i < face.size(); ++i)
    shoelace += glm::cross(face[i], face[(i + 1) % face.size()]).z / 2;
  EXPECT_NEAR(area, shoelace, 1e-9);
  EXPECT_NEAR(turned, shoelace, 1e-9);
}

}  // namespace
}  // namespace kdray::generate
