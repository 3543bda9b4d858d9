// What    The parts of what `kdray info` prints, as JSON; info.cpp makes text for people of it, so that there
//         is one source of figures for both.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "accel/flatten/flatten.h"
#include "accel/flatten/wide.h"
#include "accel/kdtree/statistics.h"
#include "accel/kdtree/tree.h"
#include "apps/cli/stats.h"
#include "scene/model/geometry.h"
#include "scene/model/scene.h"

namespace kdray::cli {

// The parts of a scene that have primitives or instances: how many there are, and the first of them, `most`
// or fewer, since a file may have a million.
struct Parts {
  std::size_t count = 0;
  Json first = Json::array();
};
Parts parts_report(const scene::Scene& scene, std::size_t most);

Json scene_report(const scene::Scene& scene, const scene::Geometry& geometry, Json parts);
Json tree_report(const kdtree::Statistics& statistics);

// What takes memory on the way from a file to the device.
struct MemoryUsers {
  const scene::Scene& scene;
  const scene::Geometry& geometry;
  const kdtree::Tree& tree;
  const flatten::FlatScene& flat;
  const flatten::WideForm& wide;
  std::optional<std::uint64_t> build_peak;  // of building and flattening, beyond scene and geometry
  std::uint64_t process_peak;
};

Json memory_report(const MemoryUsers& users);

}  // namespace kdray::cli
