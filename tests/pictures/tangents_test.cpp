// What    Normals bent by a picture in the tangent space that a glTF file brings (TANGENT), against the
//         specification's formula in double: handedness, tangents that the coordinates don't have, tangents
//         that differ from corner to corner, nodes that mirror and stretch, instances, morph targets.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>

#include "pictures/render.h"
#include "scene/gltf_samples.h"
#include "scene/import/load.h"
#include "scene/pictures.h"

namespace kdray::test {
namespace {

using nlohmann::json;

constexpr int kSide = 32;
constexpr unsigned kSeed = 41;
constexpr double kWidth = 0.9;
constexpr std::array<std::uint16_t, 3> kBump = {191, 100, 230};  // of the picture of normals
const dvec3 kWay{0.3, 0.2, -1};
constexpr std::array<std::array<std::size_t, 3>, 2> kFaces = {{{0, 1, 2}, {0, 2, 3}}};

using Tangents = std::array<glm::dvec4, 4>;
using Corners = std::array<dvec3, 4>;
constexpr double kSquare[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

// The unit square facing +z, its picture the right way round, with normals and these tangents.
GltfSample square_with(const Tangents& tangents) {
  GltfSample sample = square();
  sample.json["materials"] = {{{"normalTexture", {{"index", 0}}},
                               {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}}};
  sample.json["images"] = {
      {{"uri", "data:image/png;base64," + base64(png(1, 1, 3, {kBump[0], kBump[1], kBump[2]}))}}};
  sample.json["textures"] = {{{"source", 0}}};
  json& attributes = sample.primitive()["attributes"];
  sample.primitive()["material"] = 0;
  const int pairs = sample.view(bytes_of<float>({0, 1, 1, 1, 1, 0, 0, 0}));
  attributes["TEXCOORD_0"] = sample.accessor(pairs, 5126, "VEC2", 4);
  attributes["NORMAL"] = sample.vectors({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  std::vector<float> values;
  for (const glm::dvec4& t : tangents)
    for (int k = 0; k < 4; ++k) values.push_back(static_cast<float>(t[k]));
  attributes["TANGENT"] = sample.accessor(sample.view(bytes_of(values)), 5126, "VEC4", 4);
  return sample;
}

Picture rendered(const GltfSample& sample, Instances instances = Instances::flat) {
  LoadOptions options;
  options.instances = instances;
  Scene scene = Scene::from_memory(sample.text(), "a.gltf", options);
  EXPECT_EQ(scene.model().warnings, std::vector<std::string>{});
  scene.add_light({.kind = Light::Kind::directional, .direction = {kWay.x, kWay.y, kWay.z}});
  scene.set_camera({.from = {0.5, 0.5, 3}, .at = {0.5, 0.5, 0}, .ortho_width = kWidth});
  Renderer renderer(scene, {}, device_of());
  return renderer.render(exact_options(kSide, kSide, 2));
}

// The light at a place by the specification: normal, tangent and cross(normal, tangent) * w span the space of
// the picture, x to the right, y up, z out.
double light_at(const dvec3& normal, const dvec3& tangent, double w) {
  const dvec3 t = glm::normalize(tangent - normal * glm::dot(normal, tangent));
  const dvec3 b = glm::cross(normal, t) * w;
  const auto part = [](std::uint16_t code) { return 2 * code / 255.0 - 1; };
  const dvec3 bent = glm::normalize(t * part(kBump[0]) + b * part(kBump[1]) + normal * part(kBump[2]));
  return 0.1 + std::max(glm::dot(bent, -glm::normalize(kWay)), 0.0);
}

// The square's front, moved by `linear` within its plane or mirrored through it.
void expect_by_specification(const Picture& picture, const Tangents& tangents,
                             const dmat3& linear = dmat3(1)) {
  const dmat3 back = glm::inverse(linear);
  const double side = glm::determinant(linear) < 0 ? -1 : 1;
  const dvec3 normal = glm::normalize(glm::transpose(back) * dvec3(0, 0, 1));
  double worst = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const auto along = [](int i) { return 0.5 + ((i + 0.5) / kSide - 0.5) * kWidth; };
      const dvec3 at =
          back * (dvec3(along(x), along(kSide - 1 - y), 0) - dvec3(0.5, 0.5, 0)) + dvec3(0.5, 0.5, 0);
      if (std::abs(at.x - at.y) < 1e-3) continue;  // on the triangles' common edge
      const auto& face = kFaces[at.y > at.x];
      const double w1 = at.y > at.x ? at.x : at.x - at.y, w2 = at.y > at.x ? at.y - at.x : at.y;
      const glm::dvec4 t =
          tangents[face[0]] * (1 - w1 - w2) + tangents[face[1]] * w1 + tangents[face[2]] * w2;
      const double wanted = light_at(normal, glm::normalize(linear * dvec3(t)), t.w * side);
      const double got = picture.rgb[3 * static_cast<std::size_t>(y * kSide + x)];
      worst = std::max(worst, std::abs(got - wanted));
    }
  EXPECT_LT(worst, 2e-5);
}

Tangents alike(double degrees, double w) {
  const double a = degrees / 180 * 3.14159265358979323846;
  const glm::dvec4 t(std::cos(a), std::sin(a), 0, w);
  return {t, t, t, t};
}

// Turned about the square's middle.
void place(GltfSample& sample, const dmat3& m) {
  const dvec3 by = dvec3(0.5, 0.5, 0) - m * dvec3(0.5, 0.5, 0);
  json& node = sample.json["nodes"][0];
  node["matrix"] = {m[0].x, m[0].y, m[0].z, 0, m[1].x, m[1].y, m[1].z, 0,
                    m[2].x, m[2].y, m[2].z, 0, by.x,   by.y,   by.z,   1};
}

TEST(Tangents, HandednessTurnsThePictureOver) {
  for (const double w : {1.0, -1.0}) expect_by_specification(rendered(square_with(alike(0, w))), alike(0, w));
  EXPECT_FALSE(same_bits(rendered(square_with(alike(0, 1))).rgb, rendered(square_with(alike(0, -1))).rgb));
}

TEST(Tangents, AreTheFilesAndNotThoseOfCoordinates) {
  for (const double degrees : {30.0, 90.0, 135.0, 180.0, -100.0})
    for (const double w : {1.0, -1.0}) {
      SCOPED_TRACE(degrees);
      expect_by_specification(rendered(square_with(alike(degrees, w))), alike(degrees, w));
    }
}

// Mixed between the corners, as unit vectors that lean out of the plane as well.
TEST(Tangents, AreMixedBetweenCorners) {
  RecordProperty("seed", kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> part(-1, 1);
  for (int i = 0; i < 8; ++i) {
    Tangents tangents;
    for (glm::dvec4& t : tangents) {
      const dvec3 d = glm::normalize(dvec3(1, 0, 0) + dvec3(part(random), part(random), part(random)) * 0.7);
      t = {d.x, d.y, d.z, i % 2 ? 1 : -1};
    }
    expect_by_specification(rendered(square_with(tangents)), tangents);
  }
}

TEST(Tangents, MoveWithTheirNode) {
  const dmat3 mirrored(dvec3(-1, 0, 0), dvec3(0, 1, 0), dvec3(0, 0, 1));
  const dmat3 stretched(dvec3(2, 0, 0), dvec3(0.5, 1.25, 0), dvec3(0, 0, 3));
  const double c = std::cos(0.7), s = std::sin(0.7);
  const dmat3 turned(dvec3(1.5 * c, 1.5 * s, 0), dvec3(-1.5 * s, 1.5 * c, 0), dvec3(0, 0, 1.5));
  for (const dmat3& m : {mirrored, stretched, turned, mirrored * stretched, turned * mirrored})
    for (const double degrees : {0.0, 50.0})
      for (const Instances instances : {Instances::flat, Instances::kept}) {
        GltfSample sample = square_with(alike(degrees, 1));
        place(sample, m);
        // A second node that shares the mesh makes an instance of it.
        sample.json["nodes"].push_back({{"mesh", 0}, {"translation", {50, 0, 0}}});
        sample.json["scenes"][0]["nodes"] = {0, 1};
        // Over there is nothing to be seen of it.
        expect_by_specification(rendered(sample, instances), alike(degrees, 1), m);
      }
}

// A target turns them by what it adds, as it does with normals.
TEST(Tangents, AreMorphed) {
  GltfSample sample = square_with(alike(0, 1));
  sample.primitive()["targets"] = {{{"TANGENT", sample.vectors({-1, 1, 0, -1, 1, 0, -1, 1, 0, -1, 1, 0})}}};
  sample.json["meshes"][0]["weights"] = {0.5};
  expect_by_specification(rendered(sample), alike(45, 1));
}

// One of no length at a corner: the triangle's own is taken, which is that of its coordinates.
TEST(Tangents, OfNoLengthAreThoseOfCoordinates) {
  Tangents tangents = alike(77, -1);
  tangents[0] = glm::dvec4(0, 0, 0, 1);
  expect_by_specification(rendered(square_with(tangents)), alike(0, 1));
}

}  // namespace
}  // namespace kdray::test
