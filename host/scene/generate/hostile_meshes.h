// What    Meshes made to break a builder of kd-trees: in time, in references, in memory. All from a seed.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "scene/model/scene.h"

namespace kdray::generate {

struct HostileMesh {
  std::string_view name, what;
  scene::Scene (*make)(std::uint32_t n_triangles);
};

std::span<const HostileMesh> hostile_meshes();
std::span<const std::string_view> hostile_names();

}  // namespace kdray::generate
