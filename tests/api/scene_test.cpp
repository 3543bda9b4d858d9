// Scenes made of a program's arrays: what is refused and how it is told, ids, numbers, masks, changes, and
// pictures that are those of the same scene from a file.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "kdray/kdray.h"
#include "scene/model/scene.h"
#include "support/device.h"
#include "support/errors.h"
#include "support/folder.h"
#include "support/meshes.h"

namespace kdray {
namespace {

using test::Cube;
using test::fails;

class MadeScene : public test::EachDevice {
 protected:
  CommitOptions options() const {
    CommitOptions options;
    options.device.device = GetParam();
    return options;
  }
};
KDRAY_FOR_EACH_DEVICE(MadeScene);

struct Answers {
  explicit Answers(std::size_t n) : t(n), geometry(n), primitive(n), normal(n) {}
  HitsOut out() { return {.t = t, .geometry = geometry, .primitive = primitive, .normal = normal}; }

  std::vector<double> t;
  std::vector<std::uint32_t> geometry, primitive;
  std::vector<std::array<double, 3>> normal;
};

TEST(SceneOfArrays, NamesTheArrayAndTheElementThatAreWrong) {
  const Cube cube;
  Scene scene;
  std::vector<std::uint32_t> beyond = cube.triangles;
  beyond[4] = 8;
  EXPECT_TRUE(fails([&] { scene.add_mesh({cube.vertices, beyond}); }, "triangles[1]"));
  const std::vector<std::int64_t> negative = {0, 1, -1};
  EXPECT_TRUE(fails([&] { scene.add_mesh({cube.vertices, negative}); }, "(0, 1, -1)"));
  std::vector<float> bad = cube.vertices;
  bad[7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(fails([&] { scene.add_mesh({bad, cube.triangles}); }, "vertices[2]: not finite"));
  const std::vector<float> two_normals(6, 1.0f);
  EXPECT_TRUE(fails(
      [&] {
        scene.add_mesh({cube.vertices, cube.triangles, two_normals});
      },
      "normals: 2 of them"));
  const std::vector<float> no_normals(24, 0.0f);
  EXPECT_TRUE(fails([&] { scene.add_mesh({cube.vertices, cube.triangles, no_normals}); }, "normals[0]"));
  const std::vector<double> centers = {0, 0, 0, 1, 1, 1}, radii = {1, -1};
  EXPECT_TRUE(fails([&] { scene.add_spheres({centers, radii}); }, "spheres[1]"));
  EXPECT_TRUE(fails([&] { scene.add_spheres({centers, std::vector<double>{1, 1, 1}}); }, "radii: 3 of them"));
  EXPECT_TRUE(fails(
      [&] {
        scene.add_mesh({cube.vertices, cube.triangles}, {.material = 1});
      },
      "material 1", ErrorCode::usage));
  EXPECT_TRUE(fails([&] { scene.remove(0); }, "no geometry 0", ErrorCode::usage));
  const std::vector<double> axes = {0, 0, 1, 0, 1, 0}, up = {0, 0, 1}, one = {1}, thin = {0.1, 0}, none;
  EXPECT_TRUE(fails([&] { scene.add_tori({centers, up, one, one}); }, "axes: 1 of them for 2"));
  EXPECT_TRUE(fails([&] { scene.add_tori({centers, axes, none, one}); }, "major_radii: 0 of"));
  EXPECT_TRUE(fails(
      [&] {
        scene.add_tori({centers, axes, one, std::vector<double>(3, 0.1)});
      },
      "minor_radii: 3 of"));
  EXPECT_TRUE(fails([&] { scene.add_tori({centers, axes, one, thin}); }, "tori[1]: a torus needs"));
  EXPECT_TRUE(fails([&] { scene.add_tori({centers, axes, one, one}); }, "tori[0]: the minor_radius"));
  EXPECT_TRUE(scene.geometries().empty()) << "what was refused has left nothing behind";
}

TEST_P(MadeScene, TellsGeometryPrimitiveAndNormal) {
  const Cube cube;
  Scene scene;
  const std::vector<double> center = {10, 0, 0}, radius = {1};
  const GeometryId ball = scene.add_spheres({center, radius}, {.name = "ball"});
  const GeometryId box = scene.add_mesh({cube.vertices, cube.triangles}, {.name = "box"});
  scene.commit(options());
  const std::vector<double> origins = {10, 0, 5, 0.25, 0.25, 5, 5, 0, 5}, down = {0, 0, -2};
  Answers a(3);
  const QueryReport report = scene.closest({origins, down}, a.out());
  EXPECT_EQ(report.invalid, 0u);
  EXPECT_EQ(a.geometry, (std::vector<std::uint32_t>{ball, box, kNoGeometry}));
  EXPECT_EQ(a.primitive[0], 0u);
  EXPECT_LT(a.primitive[1], 12u);
  EXPECT_EQ(a.primitive[2], kNoPrimitive);
  EXPECT_DOUBLE_EQ(a.t[0], 2);
  EXPECT_DOUBLE_EQ(a.t[1], 2);
  EXPECT_EQ(a.t[2], std::numeric_limits<double>::infinity());
  EXPECT_NEAR(a.normal[0][2], 1, 1e-7);
  EXPECT_EQ(a.normal[1], (std::array<double, 3>{0, 0, 1}));
  EXPECT_EQ(a.normal[2], (std::array<double, 3>{0, 0, 0}));
  EXPECT_EQ(scene.info(box).name, "box");
  EXPECT_EQ(scene.info(box).primitives, 12u);
}

// In the plane of its circle it is crossed four times; what is told of it is what a file's is.
TEST_P(MadeScene, ToriAreThoseOfTheSameSceneFromAFile) {
  const std::vector<double> centers = {0, 0, 0, 20, 1, -2}, axes = {0, 0, 2, 1, 2, 3}, minor = {0.5, 1.25};
  Scene file = Scene::from_memory(R"({"objects": [
    {"type": "torus", "center": [0, 0, 0], "axis": [0, 0, 2], "major_radius": 4, "minor_radius": 0.5},
    {"type": "torus", "center": [20, 1, -2], "axis": [1, 2, 3], "major_radius": 4, "minor_radius": 1.25}]})",
                                  "rings.json");
  Scene made;
  const GeometryId rings = made.add_tori({centers, axes, std::vector<double>{4}, minor});
  EXPECT_EQ(made.info(rings).primitives, 2u);
  file.commit(options()), made.commit(options());
  std::vector<double> from = {9, 0, 0, 4, 0, 5, 0, 0, 5, 9, 0, 0},
                      to = {-1, 0, 0, 0, 0, -1, 0, 0, -1, 1, 0.1, 0};
  for (int i = 0; i < 500; ++i) {
    from.insert(from.end(), {20 + 5 * std::sin(2.1 * i), 1 + 5 * std::sin(1.3 * i), 9});
    to.insert(to.end(), {2 * std::sin(0.7 * i), 2 * std::sin(1.1 * i), -8});
  }
  const std::size_t n = from.size() / 3;
  Answers a(n), b(n);
  std::vector<std::uint32_t> crossed(n);
  made.closest({from, to}, a.out());
  file.closest({from, to}, b.out());
  made.count({from, to}, crossed);
  EXPECT_EQ(a.t, b.t);
  EXPECT_EQ(a.primitive, b.primitive);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(crossed[0], 4u);
  EXPECT_NEAR(a.t[0], 4.5, 1e-5);
  EXPECT_NEAR(a.normal[0][0], 1, 1e-6);
  EXPECT_EQ(crossed[1], 2u);
  EXPECT_NEAR(a.t[1], 4.5, 1e-5);
  EXPECT_NEAR(a.normal[1][2], 1, 1e-6);
  EXPECT_EQ(crossed[2], 0u);
  std::size_t n_of_second = 0;
  for (std::size_t i = 4; i < n; ++i) {
    EXPECT_EQ(crossed[i] % 2, 0u) << "ray " << i;
    n_of_second += a.primitive[i] == 1;
  }
  EXPECT_GT(n_of_second, 100u);
}

TEST_P(MadeScene, AsksNothingBeforeItIsCommitted) {
  Scene scene;
  const std::vector<float> one = {0, 0, 1};
  std::vector<std::uint8_t> hit(1);
  EXPECT_TRUE(fails([&] { scene.any({one, one}, hit); }, "committed", ErrorCode::usage));
}

TEST_P(MadeScene, EmptyScenesAreMissed) {
  Scene scene;
  scene.commit(options());
  const std::vector<float> one = {0, 0, 1};
  Answers a(1);
  scene.closest({one, one}, a.out());
  EXPECT_EQ(a.geometry[0], kNoGeometry);
  std::vector<std::uint8_t> hit(1, 7);
  scene.any({one, one}, hit);
  EXPECT_EQ(hit[0], 0);
}

TEST_P(MadeScene, QueriesSeeWhatWasCommittedLast) {
  const Cube cube;
  Scene scene;
  const GeometryId near = scene.add_mesh({cube.at(0, 0, 3), cube.triangles});
  const GeometryId far = scene.add_mesh({cube.at(0, 0, -3), cube.triangles});
  scene.commit(options());
  const std::vector<float> from = {0.25f, 0.25f, 9}, down = {0, 0, -1};
  const auto hit = [&] {
    Answers a(1);
    scene.closest({from, down}, a.out());
    return std::pair{a.geometry[0], a.t[0]};
  };
  EXPECT_EQ(hit(), (std::pair{near, 5.0}));
  scene.enable(near, false);
  EXPECT_EQ(hit(), (std::pair{near, 5.0})) << "not committed yet";
  scene.commit(options());
  EXPECT_EQ(hit(), (std::pair{far, 11.0}));
  scene.update_vertices(far, cube.at(0, 0, 1));
  scene.commit(options());
  EXPECT_EQ(hit(), (std::pair{far, 7.0}));
  scene.enable(near, true);
  scene.remove(far);
  scene.commit(options());
  EXPECT_EQ(hit(), (std::pair{near, 5.0}));
  EXPECT_TRUE(fails([&] { scene.info(far); }, "no geometry", ErrorCode::usage));
  const GeometryId next = scene.add_mesh({cube.at(0, 0, 7), cube.triangles});
  EXPECT_NE(next, far) << "ids are not given twice";
}

TEST_P(MadeScene, RaysMeetGeometriesWithABitInCommon) {
  const Cube cube;
  Scene scene;
  std::vector<GeometryId> ids;
  for (std::uint32_t i = 0; i < 8; ++i)
    ids.push_back(scene.add_mesh({cube.at(0, 0, 30.0f - 3 * static_cast<float>(i)), cube.triangles},
                                 {.mask = 1u << i}));
  scene.commit(options());
  // A thousand rays with all masks of eight bits: the nearest cube of those is hit.
  constexpr std::size_t kRays = 1000;
  std::vector<float> from, down = {0, 0, -1};
  std::vector<std::uint32_t> masks;
  for (std::size_t i = 0; i < kRays; ++i) {
    from.insert(from.end(), {-0.9f + 0.0017f * static_cast<float>(i), 0.1f, 90});
    masks.push_back(static_cast<std::uint32_t>(i % 256));
  }
  Answers a(kRays);
  std::vector<std::uint8_t> any(kRays);
  const Rays rays{from, down, {}, {}, masks};
  scene.closest(rays, a.out());
  scene.any(rays, any);
  for (std::size_t i = 0; i < kRays; ++i) {
    const std::uint32_t mask = masks[i];
    const GeometryId expected =
        mask == 0 ? kNoGeometry : ids[static_cast<std::size_t>(std::countr_zero(mask))];
    EXPECT_EQ(a.geometry[i], expected) << "mask " << mask;
    EXPECT_EQ(any[i], mask != 0) << "mask " << mask;
  }
  // A geometry's mask counts from the next commit on.
  scene.set_mask(ids[0], 2);
  scene.commit(options());
  Answers b(1);
  scene.closest({std::vector<float>{0, 0.1f, 90}, down, {}, {}, std::vector<std::uint32_t>{1}}, b.out());
  EXPECT_EQ(b.geometry[0], kNoGeometry);
}

TEST_P(MadeScene, PicturesAreThoseOfTheSameSceneFromAFile) {
  const std::string text = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  const std::vector<double> vertices = {-1, -1, 0, 1, -1, 0, 0, 1, 0, 0, 0, 1};
  const std::vector<std::uint32_t> triangles = {0, 1, 2, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  const Scene file = Scene::from_memory(text, "pyramid.obj");
  Scene made;
  const scene::Material& m = file.model().materials.front();
  const auto color = [](const vec3& v) { return Color{v.x, v.y, v.z}; };
  const MaterialId material = made.add_material({.emission = color(m.emission),
                                                 .ambient = color(m.ambient),
                                                 .diffuse = color(m.diffuse),
                                                 .specular = color(m.specular),
                                                 .reflect = color(m.reflect),
                                                 .transmit = color(m.transmit),
                                                 .shine = m.shine,
                                                 .index = m.index});
  made.add_mesh({vertices, triangles}, {.material = material});
  RenderOptions picture;
  picture.width = picture.height = 64;
  DeviceOptions device;
  device.device = GetParam();
  EXPECT_EQ(Renderer(made, {}, device).render(picture).rgb, Renderer(file, {}, device).render(picture).rgb);
}

TEST_P(MadeScene, ASceneFromAFileTakesMore) {
  const Cube cube;
  Scene scene = Scene::from_memory("v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n", "triangle.obj");
  const GeometryId added = scene.add_mesh({cube.at(0, 0, 3), cube.triangles});
  EXPECT_EQ(added, 1u);
  EXPECT_EQ(scene.primitives(), 13u);
  scene.commit(options());
  const std::vector<float> from = {0, 0, 9, 0, 0, 1}, down = {0, 0, -1};
  Answers a(2);
  scene.closest({from, down}, a.out());
  EXPECT_EQ(a.geometry, (std::vector<std::uint32_t>{1, 0}));
  EXPECT_TRUE(fails([&] { scene.update_vertices(0, cube.vertices); }, "the file's", ErrorCode::usage));
  scene.remove(0);
  scene.commit(options());
  scene.closest({from, down}, a.out());
  EXPECT_EQ(a.geometry, (std::vector<std::uint32_t>{1, kNoGeometry}));
}

// What is in the cache under a file's name is the file's alone.
TEST_P(MadeScene, AChangedSceneIsNotKeptAsItsFile) {
  const test::Folder folder;
  const auto file = folder.put("triangle.obj", "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n");
  const SceneCache cache({.folder = folder / "cache", .min_bytes = 0});
  Scene scene = Scene::load(file);
  scene.commit(options());
  EXPECT_TRUE(cache.keep(scene.prepared()));
  const Cube cube;
  scene.add_mesh({cube.vertices, cube.triangles});
  scene.commit(options());
  EXPECT_FALSE(cache.keep(scene.prepared()));
}

// A camera and lights that were made up for a file alone are made up anew for all that is there.
TEST_P(MadeScene, WhatWasMadeUpForAFileIsMadeUpAnew) {
  const std::string text = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n";
  const Cube cube;
  Scene scene = Scene::from_memory(text, "triangle.obj");
  const dvec3 before = scene.model().camera->from;
  scene.add_mesh({cube.at(50, 0, 0), cube.triangles});
  EXPECT_GT(glm::length(scene.model().camera->from - before), 10) << "it steps back to show both";
  scene.add_light({.position = {0, 0, 9}});
  EXPECT_EQ(scene.model().lights.size(), 1u);
  EXPECT_TRUE(fails([&] { scene.add_light({.kind = static_cast<Light::Kind>(7)}); }, "no such kind"));
}

TEST(SceneOfAFile, HitsAreToldByName) {
  const test::Folder folder;
  Scene scene = Scene::load(folder.put(
      "a.obj",
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no left\nusemtl brass\nf 1 2 3\nf 1 2 3\no right\nf 1 2 3\n"));
  const GeometryId file = 0;
  const std::vector<Part> parts = scene.parts(file);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].name, "left");
  EXPECT_EQ(parts[0].first, 1u);
  EXPECT_EQ(parts[0].count, 2u);
  EXPECT_EQ(parts[1].name, "right");
  EXPECT_TRUE(scene.instance_parts(file).empty());
  EXPECT_EQ(scene.name_of(file, 0), scene.info(file).name);
  EXPECT_EQ(scene.name_of(file, 2), "left");
  EXPECT_EQ(scene.name_of(kNoGeometry, kNoPrimitive), "");

  const Cube cube;
  const MaterialId plain = scene.add_material({}), red = scene.add_material({.diffuse = {1, 0, 0}});
  const GeometryId added = scene.add_mesh({cube.vertices, cube.triangles}, {.name = "cube", .material = red});
  EXPECT_EQ(scene.name_of(added, 3), "cube");
  EXPECT_TRUE(scene.parts(added).empty());
  const std::vector<MaterialInfo> materials = scene.materials();
  ASSERT_EQ(materials.size(), 4u);  // two of the file's
  EXPECT_EQ(materials[scene.material_of(file, 3)].name, "brass");
  EXPECT_EQ(materials[scene.material_of(file, 3)].primitives, 3u);
  EXPECT_EQ(scene.material_of(file, 4), kNoMaterial);
  EXPECT_EQ(scene.material_of(added, 0), 2 + red);
  EXPECT_EQ(materials[2 + red].primitives, 12u);
  EXPECT_EQ(materials[2 + plain].primitives, 0u);
  EXPECT_TRUE(fails([&] { static_cast<void>(scene.name_of(7, 0)); }, "no geometry 7", ErrorCode::usage));
}

TEST(SceneOfAFile, InstancesAreToldByName) {
  const test::Folder folder;
  folder.put("square.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl tin\nf 1 2 3\n");
  LoadOptions options;
  options.instances = Instances::kept;
  Scene scene = Scene::load(folder.put("a.json", R"({"materials": {"red": {"color": [1, 0, 0]}}, "objects": [
      {"type": "mesh", "file": "square.obj", "instances": [{}, {"material": "red"}]}]})"),
                            options);
  const auto material = [&](std::uint32_t instance) {
    return scene.materials().at(scene.material_of(0, 0, instance)).name;
  };
  EXPECT_EQ(material(0), "tin");
  EXPECT_EQ(material(1), "red");
  const Cube cube;
  const GeometryId prototype = scene.add_mesh({cube.vertices, cube.triangles}, {.prototype = true});
  const std::vector<double> at = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  const GeometryId copies = scene.add_instances(prototype, at, {.name = "copies"});
  EXPECT_EQ(scene.name_of(copies, 0, 0), "copies");
  EXPECT_EQ(scene.material_of(copies, 0, 0), scene.materials().size() - 1);
}

}  // namespace
}  // namespace kdray
