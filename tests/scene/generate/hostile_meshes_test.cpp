// What    The hostile meshes are as large as asked for and as bad as they say.
#include "scene/generate/hostile_meshes.h"

#include <gtest/gtest.h>

#include <set>

#include "scene/generate/displaced_sphere.h"
#include "scene/model/check_scene.h"
#include "scene/model/geometry.h"

namespace kdray::generate {
namespace {

constexpr std::uint32_t kTriangles = 2000;

scene::Scene made(std::string_view name) {
  for (const HostileMesh& m : hostile_meshes())
    if (m.name == name) return m.make(kTriangles);
  ADD_FAILURE() << name;
  return {};
}

TEST(HostileMeshes, AreSoundAndOfTheSizeAskedFor) {
  std::set<std::string_view> names;
  for (const HostileMesh& m : hostile_meshes()) {
    SCOPED_TRACE(m.name);
    EXPECT_TRUE(names.insert(m.name).second);
    const scene::Scene s = m.make(kTriangles);
    EXPECT_NO_THROW(scene::check_scene(s));
    EXPECT_GE(s.triangles.size(), kTriangles);
    EXPECT_LE(s.triangles.size(), kTriangles * 11 / 10);
    const scene::Geometry g = scene::make_geometry(s);
    EXPECT_LE(g.dropped_degenerate, m.name == "degenerate" ? s.triangles.size() : kTriangles / 20);
  }
  EXPECT_EQ(names.size(), hostile_names().size());
}

TEST(HostileMeshes, AreAsBadAsTheySay) {
  const scene::Geometry degenerate = scene::make_geometry(made("degenerate"));
  EXPECT_NEAR(static_cast<double>(degenerate.dropped_degenerate) /
                  static_cast<double>(degenerate.dropped_degenerate + degenerate.size()),
              0.6, 0.001);
  const DBox coplanar = made("coplanar").bounds();
  EXPECT_EQ(coplanar.lo.y, coplanar.hi.y);
  const scene::Scene same = made("same"), fan = made("fan");
  EXPECT_EQ(same.vertices.size(), 3u);
  for (const scene::Triangle& t : fan.triangles) EXPECT_EQ(t.vertex[0], 0u);
  std::size_t near = 0;
  const scene::Scene point = made("point");
  for (const dvec3& v : point.vertices) near += glm::length(v) < 0x1p-29;
  EXPECT_EQ(near, 3 * (kTriangles - 1));
  // The points are still apart as floats.
  EXPECT_EQ(scene::make_geometry(point).dropped_degenerate, 0u);
}

TEST(HostileMeshes, ThePlainOneIsOfTheSizeAskedFor) {
  for (const std::size_t n : {1000u, 12345u, 100000u}) {
    const std::size_t triangles = displaced_sphere_of(n).triangles.size();
    EXPECT_GE(triangles, n);
    EXPECT_LE(triangles, n + n / 10);
  }
}

}  // namespace
}  // namespace kdray::generate
