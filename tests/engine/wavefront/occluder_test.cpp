// What    Packets of shadow rays go from the light on (kernels/traverse/packet_frustum.clh), and what stopped
//         one is tried first on the next (packet.clh): it changes time, never which rays are stopped,
//         whatever walk they take.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "conformance/samples.h"
#include "kdray/kdray.h"
#include "oracle/build_scene.h"
#include "support/device.h"

namespace kdray {
namespace {

// Many spheres and few of every other kind: what takes a node for a leaf reads far beyond the few.
scene::Scene blockers(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto point = [&] {
    const double x = unit(random), y = unit(random), z = unit(random);
    return dvec3(x, y, z);
  };
  const scene::Material any = oracle::matte(vec3(1));
  oracle::SceneBuilder b;
  for (int i = 0; i < 6000; ++i) {
    const dvec3 center = point();
    b.sphere(center, 0.05 * std::pow(10, -0.9 + 0.9 * unit(random)), any);
  }
  for (int i = 0; i < 3; ++i) {
    const dvec3 p = point(), q = p + 0.2 * point(), r = p + 0.2 * point();
    b.triangle(p, q, r, any);
  }
  test::Draw draw(seed);
  b.change([&](scene::Scene& s) {
    primitives::for_each_shape([&](auto kind) {
      using Kind = decltype(kind);
      if constexpr (!std::is_same_v<Kind, primitives::SphereKind>)
        for (int i = 0; i < 3; ++i) test::Samples<Kind>::add(s, 0, draw);
    });
  });
  return b.scene();
}

// Side by side from a floor to a light.
std::vector<Ray> shadow_rays(const vec3& light) {
  constexpr int kAcross = 160;
  std::vector<Ray> rays;
  for (int y = 0; y < kAcross; ++y)
    for (int x = 0; x < kAcross; ++x) {
      const auto along = [](int i) { return 3.0f * (static_cast<float>(i) + 0.5f) / kAcross - 1.5f; };
      const vec3 from(along(x), -1.5f, along(y)), way = light - from;
      rays.push_back({{from.x, from.y, from.z}, 0, {way.x, way.y, way.z}, 1});
    }
  return rays;
}

// Towards a light from all around it: half from side by side, the others from near and far, in the planes and
// on the axes through the light, where a ray has components of 0.
std::vector<Ray> rays_from_all_around(const vec3& light, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<Ray> rays;
  vec3 from(0);
  for (int i = 0; i < 25600; ++i) {
    const float far = std::pow(10.0f, unit(random));
    vec3 offset(0);
    for (int k = 0; k < 3; ++k) offset[k] = unit(random);
    from = i / 16 % 2 == 0 && i % 16 != 0 ? from + 0.02f * offset : light + far * offset;
    const int on_axes = i / 32 % 3;
    for (int k = 0; k < on_axes; ++k) from[(i + k) % 3] = light[(i + k) % 3];
    const vec3 way = light - from;
    rays.push_back({{from.x, from.y, from.z}, 0, {way.x, way.y, way.z}, 1});
  }
  return rays;
}

// For each ray whether something is in its way.
std::vector<bool> stopped(Renderer& renderer, const std::vector<Ray>& rays, Traversal traversal) {
  std::vector<bool> all;
  for (const Hit& h : renderer.trace(rays, true, 1, traversal)) all.push_back(h.t == 0);
  return all;
}

void expect_alike(Renderer& renderer, const std::vector<Ray>& rays) {
  const std::vector<bool> wanted = stopped(renderer, rays, Traversal::binary);
  const auto n = static_cast<std::size_t>(std::count(wanted.begin(), wanted.end(), true));
  EXPECT_GT(n, rays.size() / 10);
  EXPECT_LT(n, rays.size() * 9 / 10);
  for (const Traversal traversal :
       {Traversal::wide, Traversal::packet, Traversal::batch, Traversal::automatic})
    EXPECT_TRUE(stopped(renderer, rays, traversal) == wanted) << "traversal " << static_cast<int>(traversal);
}

class Occluders : public test::EachDevice {};

// A leaf tried by mistake stops some ray in most of these scenes, not in all.
TEST_P(Occluders, OfOtherPacketsStopWhatTheyAreInTheWayOf) {
  for (unsigned seed = 23; seed < 31; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Renderer renderer{Scene(blockers(seed)), {}, {.device = GetParam()}};
    for (const vec3 light : {vec3(0.25f, 4, -0.125f), vec3(-1, 0.5f, 2)})
      expect_alike(renderer, shadow_rays(light));
  }
}

TEST_P(Occluders, AreFoundFromAllAroundALight) {
  for (unsigned seed = 31; seed < 34; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Renderer renderer{Scene(blockers(seed)), {}, {.device = GetParam()}};
    for (const vec3 light : {vec3(0.25f, 0.5f, -0.125f), vec3(-0.5f, 0.125f, 0.75f)})
      expect_alike(renderer, rays_from_all_around(light, seed));
  }
}

KDRAY_FOR_EACH_DEVICE(Occluders);

}  // namespace
}  // namespace kdray
