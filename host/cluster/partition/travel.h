// What    Brings every primitive to the rank that holds its cell.
// Shape   In batches, which all ranks exchange at the same time. Who is to hold some knows before how many
//         come from whom, and puts each where it belongs: of each kind in the order of the file.
// Memory  The primitives that go and those that have come, and a batch.
#pragma once

#include <cstdint>
#include <span>

#include "cluster/partition/primitive_set.h"
#include "cluster/transport/together.h"

namespace kdray::partition {

// `rank_of` has the rank of each of the primitives, in the order of for_each_box(). `rows` of texture
// coordinates and colours that triangles have, the same on all ranks.
struct CornerRows {
  std::size_t colors = 0, texcoords = 0;
};
PrimitiveSet bring(PrimitiveSet set, std::span<const std::uint32_t> rank_of, const CornerRows& rows,
                   transport::Together& all);

}  // namespace kdray::partition
