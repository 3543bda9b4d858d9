// What    What is known of a scene once each rank has told what it knows of its share: counts, bounds, and
//         what the primitives need of the kernels.
// Shape   Whole numbers that add up, and boxes that grow: the same bits in any order.
#pragma once

#include <array>
#include <cstdint>

#include "base/box.h"
#include "cluster/partition/share.h"
#include "layout/features.h"
#include "scene/primitives/kinds.h"

namespace kdray::partition {

struct Facts {
  std::uint64_t dropped = 0, lost = 0, fine = 0, zero_area = 0, shaded_flat = 0;
  std::array<std::uint64_t, primitives::kKinds> counts{};
  std::uint64_t last_number = 0;  // of the triangles
  layout::Features features = 0;  // but for KDRAY_FEATURE_NUMBERS and those of light
  Box bounds;

  // Adds the next part of a scene that is flattened part by part.
  void add(const scene::Scene& scene, const scene::Geometry& geometry);
  void add(const Facts& o);
};

// Writes them into the whole of a scene of triangles alone, which has its settings.
void tell(const Facts& facts, prepare::Prepared& whole);

}  // namespace kdray::partition
