// What    The queries *closest* and *any*: a program's rays in, its arrays filled.
// Shape   Chunk by chunk, on all places at once (shared_rows.h): rays to the scene's own space (local_rays.h), traced (session.h), hits to the
//         caller's arrays.
// Errors  As kdray/query.h says. What was written before an error is left.
// Threads As many calls at once as there are threads.
#pragma once

#include "engine/query/query_context.h"
#include "kdray/query.h"

namespace kdray::query {

// What every query looks at on its way: ErrorCode::input for the first ray that means nothing, where such are
// errors, and for an array of answers of another size.
void check_invalid(const LocalRays& rays, InvalidRays invalid);
void check_out(std::size_t size, std::size_t n, const char* name);

QueryReport closest(const QueryContext& context, const Rays& rays, const HitsOut& out,
                    const QueryOptions& options);

// 1 for each ray that something lies in the way of, else 0.
QueryReport any(const QueryContext& context, const Rays& rays, const BytesOut& out,
                const QueryOptions& options);

}  // namespace kdray::query
