// What    The queries *count* and *all*: how many surfaces a program's rays cross, and all of these crossings
//         (all_hits.h).
// Errors  As kdray/query.h says.
// Threads As many calls at once as there are threads.
#pragma once

#include "engine/query/ask.h"
#include "kdray/query.h"

namespace kdray::query {

QueryReport count(const QueryContext& context, const Rays& rays, const WordsOut& out,
                  const QueryOptions& options);

AllHits all(const QueryContext& context, const Rays& rays, const AllHitsOptions& options);

}  // namespace kdray::query
