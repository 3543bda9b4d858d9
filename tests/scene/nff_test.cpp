#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "scene/import/load.h"
#include "scene/scratch.h"
#include "support/data.h"

namespace kdray::scene {
namespace {

using test::refusal;

Scene read(const std::string& text) {
  return read_nff(text, "t.nff");
}
std::string refused(const std::string& text) {
  return refusal([&] { read(text); });
}

const std::string kView = "v\nfrom 0 0 -8\nat 0 0 0\nup 0 1 0\nangle 30\nhither 0.5\nresolution 640 480\n";

TEST(Nff, ReadsTheView) {
  const Scene s = read("b 0.25 0.5 1\n" + kView);
  EXPECT_EQ(s.background, vec3(0.25f, 0.5f, 1));
  ASSERT_TRUE(s.camera);
  EXPECT_EQ(s.camera->from, dvec3(0, 0, -8));
  EXPECT_EQ(s.camera->at, dvec3(0));
  EXPECT_EQ(s.camera->up, dvec3(0, 1, 0));
  EXPECT_DOUBLE_EQ(s.camera->vertical_fov, std::acos(-1.0) / 6);
  EXPECT_EQ(s.camera->hither, 0.5);
  EXPECT_EQ(s.settings.width, 640);
  EXPECT_EQ(s.settings.height, 480);
  EXPECT_EQ(s.ambient, vec3(1));
}

TEST(Nff, MapsTheTermsOfAMaterial) {
  const Scene s = read("f 0.5 0.25 1 0.8 0.3 20 0.5 1.5\ns 0 0 0 1\n");
  ASSERT_EQ(s.materials.size(), 1u);
  const Material& m = s.materials[0];
  const vec3 color(0.5f, 0.25f, 1);
  EXPECT_EQ(m.ambient, 0.1f * color);
  EXPECT_EQ(m.diffuse, 0.8f * color);
  EXPECT_EQ(m.specular, vec3(0.3f));
  EXPECT_EQ(m.reflect, vec3(0.3f));
  EXPECT_EQ(m.transmit, 0.5f * color);
  EXPECT_EQ(m.emission, vec3(0));
  EXPECT_EQ(m.shine, 20);
  EXPECT_EQ(m.index, 1.5f);
}

TEST(Nff, AnIndexOfZeroMeansOneOnOpaqueSurfacesOnly) {
  EXPECT_EQ(read("f 1 1 1 1 0 1 0 0\ns 0 0 0 1").materials[0].index, 1);
  EXPECT_EQ(refused("\nf 1 1 1 1 0 1 0.5 0\n"),
            "t.nff:2: an index of refraction of 0 on a transparent surface");
}

TEST(Nff, SharesLightAmongLightsWithoutAColour) {
  const Scene s = read("l 1 2 3\nl 4 5 6 0.5 0.25 0\nl 0 0 0\nl 1 1 1\n");
  ASSERT_EQ(s.lights.size(), 4u);
  EXPECT_EQ(s.lights[0].color, vec3(0.5f));
  EXPECT_EQ(s.lights[0].position, dvec3(1, 2, 3));
  EXPECT_EQ(s.lights[1].color, vec3(0.5f, 0.25f, 0));
  EXPECT_EQ(s.lights[2].color, vec3(0.5f));
  EXPECT_EQ(s.lights[3].attenuation, dvec3(1, 0, 0));
}

TEST(Nff, NumbersPrimitivesInFileOrderOverAllKinds) {
  const Scene s = read(
      "f 1 0 0 1 0 1 0 0\n"
      "s 1 2 3 -4\n"
      "p 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
      "f 0 1 0 1 0 1 0 0\n"
      "c 0 0 0 1 0 0 5 -0.5\n"
      "f 1 0 0 1 0 1 0 0\n"
      "pp 3\n0 0 0 0 0 2\n1 0 0 0 3 0\n0 1 0 1 0 0\n");
  ASSERT_EQ(s.primitive_count(), 5u);
  EXPECT_EQ(s.materials.size(), 2u) << "the first and the last 'f' are the same";
  EXPECT_EQ(s.spheres[0].number, 0u);
  EXPECT_EQ(s.spheres[0].center, dvec3(1, 2, 3));
  EXPECT_EQ(s.spheres[0].radius, 4) << "a radius below 0 is its size";
  ASSERT_EQ(s.triangles.size(), 3u);
  EXPECT_EQ(s.triangles[0].number, 1u);
  EXPECT_EQ(s.triangles[1].number, 2u);
  EXPECT_EQ(s.triangles[0].normal[0], kNone);
  EXPECT_EQ(s.cones[0].number, 3u);
  EXPECT_EQ(s.cones[0].material, 1u);
  EXPECT_EQ(s.cones[0].base_radius, 1);
  EXPECT_EQ(s.cones[0].apex_radius, 0.5);
  EXPECT_EQ(s.cones[0].apex, dvec3(0, 0, 5));
  EXPECT_EQ(s.triangles[2].number, 4u);
  EXPECT_EQ(s.triangles[2].material, 0u);
  EXPECT_EQ(s.normals[s.triangles[2].normal[0]], vec3(0, 0, 1)) << "normals are made unit length";
  EXPECT_EQ(s.normals[s.triangles[2].normal[1]], vec3(0, 1, 0));
  EXPECT_EQ(s.vertices[s.triangles[2].vertex[2]], dvec3(0, 1, 0));
}

TEST(Nff, NumbersMayGoOnOverSeveralLines) {
  const Scene s = read("f 1 1 1\n 1 0 # half way\n 1 0 0 s 0\n0 0\n\n2 p 3 0 0 0 1 0 0 0 1 0");
  EXPECT_EQ(s.spheres.size(), 1u);
  EXPECT_EQ(s.spheres[0].radius, 2);
  EXPECT_EQ(s.triangles.size(), 1u);
}

TEST(Nff, ZeroNormalsFallBackToTheFaceWithOneWarning) {
  const std::string patch = "pp 3\n0 0 0 0 0 1\n1 0 0 0 0 0\n0 1 0 0 0 1\n";
  const Scene s = read("f 1 1 1 1 0 1 0 0\n" + patch + patch);
  EXPECT_EQ(s.triangles[1].normal[0], kNone);
  EXPECT_TRUE(s.normals.empty());
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_NE(s.warnings[0].find("2 normals of length 0"), std::string::npos);
}

TEST(Nff, GivesAPrimitiveWithoutMaterialAMatteOne) {
  const Scene s = read("\ns 0 0 0 1\ns 1 1 1 1");
  ASSERT_EQ(s.materials.size(), 1u);
  EXPECT_EQ(s.materials[0].diffuse, vec3(1));
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_NE(s.warnings[0].find("line 2"), std::string::npos);
}

TEST(Nff, SaysWhereAndWhatIsWrong) {
  EXPECT_EQ(refused("b 1 1 1\nx 1\n"), "t.nff:2: expected a command (v b l f c s p pp), found 'x'");
  EXPECT_EQ(refused("b 1 1\nl 0 0 0\n"),
            "t.nff:2: expected the background colour (red green blue), found 'l'");
  EXPECT_EQ(refused("b 1 1 -1\n"), "t.nff:1: the background colour (red green blue) is below 0");
  EXPECT_EQ(refused("\n\ns 0 nan 0 1\n"), "t.nff:3: expected a sphere's center (x y z), found 'nan'");
  EXPECT_EQ(refused("s 0 0 0 inf\n"), "t.nff:1: expected a sphere's radius, found 'inf'");
  EXPECT_EQ(refused("s 0 0 0 1e999\n"), "t.nff:1: expected a sphere's radius, found '1e999'");
  EXPECT_EQ(refused("s 0 0 0 0\n"), "t.nff:1: a sphere with a radius of 0");
  EXPECT_EQ(refused("s 0 0 0\n"), "t.nff:1: expected a sphere's radius, but the file ends here");
  EXPECT_EQ(refused("\nc 1 1 1 1\n  1 1 1 2\n"), "t.nff:3: a cone whose base and apex are the same point");
  EXPECT_EQ(refused("c 1 1 1 0 1 1 2 0\n"), "t.nff:1: a cone with two radii of 0");
  EXPECT_EQ(refused("p 2\n0 0 0\n1 1 1\n"), "t.nff:1: a polygon of 2 corners; it needs 3 or more");
  EXPECT_EQ(refused("p 2.5\n"), "t.nff:1: expected the number of corners of a polygon, found '2.5'");
  EXPECT_EQ(refused("p 3\n0 0 0\n1 0 0\n\n0 oops 0\n"),
            "t.nff:5: expected a corner of a polygon (x y z), found 'oops'");
  EXPECT_EQ(refused("f 1 1 1 1 0 -5 0 0\n"), "t.nff:1: the shine of 'f' is below 0");
  EXPECT_EQ(refused("f 1 1 1 1 1e300 5 0 0\n"), "t.nff:1: Ks of 'f' is too large");
}

TEST(Nff, RefusesABadView) {
  EXPECT_EQ(refused("\nv\nfrom 0 0 1\nat 0 0 0\n"), "t.nff:2: the view 'v' lacks its 'angle' line");
  EXPECT_EQ(refused("v from 1 2 3 at 1 2 3 angle 40"),
            "t.nff:1: the view: 'from' and 'at' are the same point");
  EXPECT_EQ(refused("v from 0 5 0 at 0 0 0 up 0 1 0 angle 40"),
            "t.nff:1: the view: 'up' is parallel to the view direction");
  EXPECT_EQ(refused("v from 0 5 0 at 0 0 0 up 0 0 1 angle\n180"),
            "t.nff:2: the view's angle is not between 0 and 180 degrees");
  EXPECT_EQ(refused(kView + "resolution 640 0\n"),
            "t.nff:8: the picture's height is not between 1 and 65536 pixels");
}

TEST(Nff, DoesNotTrustACount) {
  EXPECT_EQ(refused("p 4000000000\n0 0 0\n"),
            "t.nff:1: a polygon of 4000000000 corners, but the file ends before that many");
  EXPECT_EQ(refused("pp 4294967295\n0 0 0\n"),
            "t.nff:1: a polygon of 4294967295 corners, but the file ends before that many");
}

TEST(Nff, EveryPrefixOfAFileIsReadOrRefused) {
  const std::string text = "b 0.1 0.2 0.3\n" + kView +
                           "l 1 2 3\nf 1 1 1 .5 .5 10 0 0\np 5\n0 0 0\n4 0 0\n4 4 0\n2 1 0\n0 4 0\n"
                           "pp 3\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\nc 0 0 0 1 0 0 5 2\ns 1 2 3 4\n";
  for (std::size_t n = 0; n <= text.size(); ++n) {
    try {
      read(text.substr(0, n));
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input) << e.what();
    }
  }
}

// Counts taken from the files with awk: a polygon of n corners counts n - 2; materials are the distinct 'f'
// lines.
struct SpdFile {
  const char* name;
  std::size_t triangles, spheres, cones, materials, lights;
};
class Spd : public ::testing::TestWithParam<SpdFile> {};

TEST_P(Spd, LoadsWithTheRightCounts) {
  const SpdFile& want = GetParam();
  const auto file = test::data_path("spd/" + std::string(want.name) + ".nff.gz");
  KDRAY_NEED_DATA(file);
  const Scene s = load(file);
  EXPECT_EQ(s.triangles.size(), want.triangles);
  EXPECT_EQ(s.spheres.size(), want.spheres);
  EXPECT_EQ(s.cones.size(), want.cones);
  EXPECT_EQ(s.materials.size(), want.materials);
  EXPECT_EQ(s.lights.size(), want.lights);
  EXPECT_TRUE(s.camera);
  EXPECT_TRUE(s.settings.width && s.settings.height);
  EXPECT_EQ(s.name, file.string());
  EXPECT_TRUE(s.warnings.empty()) << s.warnings[0];
}

INSTANTIATE_TEST_SUITE_P(Files, Spd,
                         ::testing::Values(SpdFile{"balls", 2, 7381, 0, 2, 3},       //
                                           SpdFile{"gears", 36610, 0, 0, 63, 5},     //
                                           SpdFile{"jacks", 0, 6, 3, 1, 1},          //
                                           SpdFile{"lattice", 0, 2197, 6084, 4, 6},  //
                                           SpdFile{"mount", 8192, 4, 0, 2, 1},       //
                                           SpdFile{"nurbtst", 1500, 0, 0, 1, 1},     //
                                           SpdFile{"rings", 2, 4200, 4200, 7, 3},    //
                                           SpdFile{"sample", 880, 0, 1, 4, 1},       //
                                           SpdFile{"shells", 0, 5761, 0, 1, 1},      //
                                           SpdFile{"sombrero", 1922, 0, 0, 1, 1},    //
                                           SpdFile{"teapot", 2328, 0, 0, 3, 2},      //
                                           SpdFile{"tetra", 4096, 0, 0, 1, 1},       //
                                           SpdFile{"tree", 2, 4095, 4095, 2, 7}),
                         [](const auto& info) { return std::string(info.param.name); });

// The 144-gons of gears are concave: their triangles must cover each of them exactly once, none turned over.
TEST(Nff, CutsTheGearsWithoutOverlap) {
  const auto file = test::data_path("spd/gears.nff.gz");
  KDRAY_NEED_DATA(file);
  const Scene s = load(file);
  std::size_t first = 0;
  std::size_t large = 0;
  while (first < s.triangles.size()) {
    // A polygon's triangles share its run of vertices, which starts where the one before it ends.
    std::size_t last = first;
    std::uint32_t low = kNone, high = 0;
    const auto grow = [&](const Triangle& t) {
      for (const auto v : t.vertex) low = std::min(low, v), high = std::max(high, v);
    };
    grow(s.triangles[first]);
    while (last < s.triangles.size() && (last == first || s.triangles[last].vertex[0] <= high)) {
      grow(s.triangles[last++]);
    }
    const std::size_t n = last - first + 2;
    if (n > 4) {
      ++large;
      dvec3 polygon(0), sum(0);
      double sizes = 0;
      for (std::uint32_t i = low; i <= high; ++i) {
        polygon += glm::cross(s.vertices[i], s.vertices[i == high ? low : i + 1]);
      }
      for (std::size_t i = first; i < last; ++i) {
        const auto& v = s.triangles[i].vertex;
        const dvec3 area =
            glm::cross(s.vertices[v[1]] - s.vertices[v[0]], s.vertices[v[2]] - s.vertices[v[0]]);
        sum += area;
        sizes += glm::length(area);
      }
      const double whole = glm::length(polygon);
      EXPECT_NEAR(glm::length(sum), whole, 1e-5 * whole);
      EXPECT_NEAR(sizes, whole, 1e-5 * whole);
    }
    first = last;
  }
  EXPECT_GT(large, 50u);
}

}  // namespace
}  // namespace kdray::scene
