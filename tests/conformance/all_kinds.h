// What    Scenes of one kind, and of all kinds.
#pragma once

#include "conformance/samples.h"
#include "oracle/build_scene.h"
#include "support/all_kinds.h"

namespace kdray::test {

// A scene of n random primitives of one kind, with what makes rays of every sort: a light that throws
// shadows, mirrors and glass.
template <class Kind>
scene::Scene scene_of(int n, std::uint64_t seed) {
  Draw random(seed);
  scene::Scene s;
  scene::Material matte = oracle::matte(vec3(0.7f, 0.5f, 0.3f)), mirror = matte, glass = matte;
  mirror.reflect = vec3(0.4f), glass.transmit = vec3(0.5f), glass.index = 1.3f;
  s.materials = {matte, mirror, glass};
  s.camera = scene::Camera{.from = {0.3, 0.4, 4}, .at = {0, 0, 0}, .up = {0, 1, 0}, .vertical_fov = 0.7};
  s.lights = {{.position = {2, 3, 4}, .color = vec3(0.9f)}, {.position = {-3, 1, 2}, .color = vec3(0.4f)}};
  s.background = vec3(0.1f, 0.2f, 0.3f);
  for (int i = 0; i < n; ++i) Samples<Kind>::add(s, static_cast<std::uint32_t>(i % 3), random);
  return s;
}

// Some of every kind.
inline scene::Scene mixed_scene(int n_of_each, std::uint64_t seed) {
  scene::Scene s = scene_of<primitives::TriangleKind>(0, seed);
  Draw random(seed);
  for (int i = 0; i < n_of_each; ++i)
    primitives::for_each_kind(
        [&](auto kind) { Samples<decltype(kind)>::add(s, static_cast<std::uint32_t>(i % 3), random); });
  return s;
}

}  // namespace kdray::test
