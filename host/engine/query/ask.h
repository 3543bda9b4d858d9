// What    The queries *closest* and *any*: a program's rays in, its arrays filled.
// Shape   Chunk by chunk: rays to the scene's own space (local_rays.h), traced (session.h), hits to the
//         caller's arrays.
// Errors  As kdray/query.h says. What was written before an error is left.
// Threads As many calls at once as there are threads.
#pragma once

#include "accel/prepare/prepared.h"
#include "engine/query/all_sessions.h"
#include "engine/query/geometry_table.h"
#include "engine/query/local_rays.h"
#include "kdray/query.h"

namespace kdray::query {

// What every query needs: a scene that is ready, and what its numbers mean.
struct QueryContext {
  const Target& target;  // of rays in the scene's own space
  const GeometryTable& table;
  const LocalFrame& frame;
  AllSessions& sessions;

  const prepare::Prepared& scene() const { return target.scene; }
};

// What every query looks at on its way: ErrorCode::input for the first ray that means nothing, where such are
// errors, and for an array of answers of another size.
void check_invalid(const LocalRays& rays, const QueryOptions& options);
void check_out(std::size_t size, std::size_t n, const char* name);

QueryReport closest(const QueryContext& context, const Rays& rays, const HitsOut& out,
                    const QueryOptions& options);

// 1 for each ray that something lies in the way of, else 0.
QueryReport any(const QueryContext& context, const Rays& rays, const BytesOut& out,
                const QueryOptions& options);

}  // namespace kdray::query
