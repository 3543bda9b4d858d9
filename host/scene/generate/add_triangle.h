// What    Adds a triangle to a mesh that is being made, numbered in the order of the calls.
#pragma once

#include "scene/model/scene.h"

namespace kdray::generate {

inline void add_triangle(scene::Scene& scene, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  scene::Triangle t;
  t.vertex = {a, b, c};
  t.number = static_cast<std::uint32_t>(scene.triangles.size());
  scene.triangles.push_back(t);
}

}  // namespace kdray::generate
