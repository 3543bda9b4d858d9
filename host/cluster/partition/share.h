// What    What a rank reads of a scene, before it is known which rank will hold what: some of the primitives,
//         and all that is true of the whole scene; and the facts that each rank finds out about its share,
//         which together are those of the scene (counts, bounds, what the primitives need of the kernels).
// Shape   The shares of all ranks are the scene: each primitive once, in file order, rank by rank. Facts are
//         whole numbers that add up, and boxes that grow: the same bits in any order.
// Memory  With share_of() the whole scene is in memory until the share is taken.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "accel/prepare/prepared.h"
#include "base/box.h"
#include "cluster/partition/primitive_set.h"
#include "cluster/transport/together.h"
#include "kdray/options.h"
#include "layout/features.h"
#include "scene/primitives/kinds.h"

namespace kdray::partition {

struct Share {
  PrimitiveSet primitives;
  // Of the whole scene; without primitives, nodes and blocks, but with all that these refer to.
  prepare::Prepared whole;
};

// Reads this rank's share of a file that can be read in shares: a binary PLY whose faces are triangles.
// Returns nothing, on all ranks, where the file has to be read whole.
std::optional<Share> read_in_shares(const std::filesystem::path& file, const LoadOptions& options,
                                    transport::Together& all);

// Takes this rank's share of a scene that every rank has. Throws ErrorCode::input where their scenes differ.
Share share_of(const scene::Scene& scene, transport::Together& all);

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

// Writes the facts into the whole of a scene of triangles alone, which has its settings.
void tell(const Facts& facts, prepare::Prepared& whole);

}  // namespace kdray::partition
