// What    A scene that no rank has whole: each divides its partition among its own queues, and all get
//         to know the bounds of everybody's parts.
// Shape   The division is that of the whole scene, with parts for the queues of all ranks; those of other
//         ranks are empty here. Subtrees are this rank's own. Nothing is held by several ranks, and a
//         rank's part may have nothing in it.
// Errors  ErrorCode::internal: a rank that tells of parts which are not its own.
#pragma once

#include <cstddef>
#include <span>

#include "cluster/transport/together.h"
#include "engine/odprt/division.h"
#include "engine/odprt/rank_table.h"

namespace kdray::odprt {

// All ranks call it. `costs` of the subtrees.
Division divide_partition(const flatten::FlatScene& scene, const flatten::WideForm& form, const Cut& cut,
                          std::span<const double> costs, const RankTable& table, transport::Together& all);

// How many subtrees this rank is to cut its partition into, of those of all ranks.
std::size_t subtrees_of_rank(std::size_t n_subtrees, const RankTable& table);

}  // namespace kdray::odprt
