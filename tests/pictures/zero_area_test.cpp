// What    Faces whose edges are divided on one side alone, with triangles without area in between, look like
//         the faces undivided: in the light, in mirrors and through glass; and whatever leaves work out or
//         traces the rays.
#include <gtest/gtest.h>

#include <algorithm>

#include "layout/features.h"
#include "oracle/build_scene.h"
#include "pictures/render.h"
#include "scene/model/geometry.h"
#include "support/zero_area_meshes.h"

namespace kdray::test {
namespace {

constexpr int kWidth = 150, kHeight = 101;

// Adds a mesh with a material of its own.
void add(scene::Scene& scene, const LatticeMesh& mesh, double scale, const dvec3& offset,
         const scene::Material& material) {
  const scene::Scene part = scene_of(mesh, scale, offset);
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  scene.vertices.insert(scene.vertices.end(), part.vertices.begin(), part.vertices.end());
  scene.materials.push_back(material);
  for (scene::Triangle t : part.triangles) {
    for (auto& vertex : t.vertex) vertex += first;
    t.material = static_cast<std::uint32_t>(scene.materials.size() - 1);
    t.number = scene.primitive_count();
    scene.triangles.push_back(t);
  }
}

// A room with a mirror and a glass ball in it, seen from within; its numbers are eighths, which floats hold.
scene::Scene room(bool divided) {
  const auto mesh = [&](LatticeMesh m, std::size_t n, unsigned seed) {
    if (divided) divide_edges(m, n, seed);
    return m;
  };
  scene::Material walls = oracle::matte({0.7f, 0.6f, 0.5f}), shining = oracle::mirror(vec3(0.8f));
  walls.specular = vec3(0.3f), walls.shine = 10, walls.reflect = vec3(0.1f);
  oracle::SceneBuilder b;
  b.camera({40.5, -60.25, 170.125}, {0, 20, 0}, 0.9).ambient(vec3(0.2f));
  for (const dvec3& place : {dvec3(30, 90, 100), dvec3(-50, -100, 20), dvec3(10, 119, -170)})
    b.light(place, vec3(0.4f));
  scene::Scene s = b.scene();
  add(s, mesh(lattice_box(8 * 60), 80, 1), 0.125, dvec3(0), walls);
  add(s, mesh(lattice_ball(6, 20, 12, 3), 200, 2), 0.125, dvec3(-10, 30, 40), shining);
  add(s, mesh(lattice_ball(8, 20, 12, 4), 200, 3), 0.125, dvec3(20, -40, 60),
      oracle::glass(1.3f, vec3(0.8f), vec3(0.1f)));
  return s;
}

int n_different(const Picture& a, const Picture& b) {
  int n = 0;
  for (std::size_t i = 0; i < a.rgb.size(); i += 3) {
    float most = 0;
    for (std::size_t k = 0; k < 3; ++k) most = std::max(most, std::abs(a.rgb[i + k] - b.rgb[i + k]));
    n += most > 1e-3f ? 1 : 0;
  }
  return n;
}

TEST(ZeroArea, LooksLikeTheUndivided) {
  const scene::Scene divided = room(true);
  ASSERT_GT(scene::make_geometry(divided).zero_area.size(), 400u);
  Renderer one(Scene{room(false)}, {}, device_of()), other(Scene{scene::Scene(divided)}, {}, device_of());
  for (const Precision precision : {Precision::float32, Precision::float64}) {
    RenderOptions options = exact_options(kWidth, kHeight);
    options.precision = precision;
    const Picture a = one.render(options), b = other.render(options);
    ASSERT_GT(mean_luminance(a), 0.05);
    EXPECT_TRUE(all_finite(b));
    // At edges rounding may choose another side.
    EXPECT_LE(n_different(a, b), 15) << "of " << kWidth * kHeight << " pixels";
  }
}

TEST(ZeroArea, IsTheSameToTheBitByEveryWalk) {
  Renderer renderer(Scene{room(true)}, {}, device_of());
  RenderOptions options = exact_options(kWidth, kHeight);
  options.traversal = Traversal::binary;
  const Picture binary = renderer.render(options);
  for (const Traversal walk : {Traversal::wide, Traversal::packet, Traversal::batch, Traversal::automatic}) {
    options.traversal = walk;
    EXPECT_TRUE(same_bits(binary.rgb, renderer.render(options).rgb)) << static_cast<int>(walk);
  }
}

// The walls are faces about a core; each ray leaves out what it has left.
TEST(ZeroArea, ChangesNoBitByWhatIsLeftOut) {
  Renderer renderer(Scene{room(true)}, {}, device_of());
  const RenderOptions options = exact_options(kWidth, kHeight);
  const Picture usual = renderer.render(options);
  for (const std::uint32_t rules : {KDRAY_KEEP_OPEN, KDRAY_KEEP_LEFT, KDRAY_KEEP_ALL}) {
    api::keep(renderer, rules);
    EXPECT_TRUE(same_bits(usual.rgb, renderer.render(options).rgb)) << rules;
  }
}

TEST(ZeroArea, IsTheSameInODPRT) {
  Renderer renderer(Scene{room(true)}, {}, device_of({.queues = 2}));
  RenderOptions options = exact_options(kWidth, kHeight);
  const Picture whole = renderer.render(options);
  options.mode = Mode::odprt;
  EXPECT_TRUE(same_bits(whole.rgb, renderer.render(options).rgb));
}

}  // namespace
}  // namespace kdray::test
