// What    What a rank reads of a scene, before anybody knows who will hold what: some of the primitives, and
//         all that is true of the whole scene.
// Shape   The shares of all ranks are the scene, each primitive once, in the order of ranks in that of the
//         file.
#pragma once

#include <filesystem>
#include <optional>

#include "accel/prepare/prepared.h"
#include "cluster/partition/primitive_set.h"
#include "cluster/transport/together.h"
#include "kdray/options.h"

namespace kdray::partition {

struct Share {
  PrimitiveSet primitives;
  // Of the whole scene; without primitives, nodes and blocks, but with all that these refer to.
  prepare::Prepared whole;
};

// Of a file that is read in shares: a binary PLY whose faces are triangles. Nothing, on all ranks: it has to
// be read whole.
std::optional<Share> read_in_shares(const std::filesystem::path& file, const LoadOptions& options,
                                    transport::Together& all);

// The same of a scene that every rank has. Throws ErrorCode::input where they have different ones.
Share share_of(const scene::Scene& scene, transport::Together& all);

}  // namespace kdray::partition
