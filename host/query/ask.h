// What    The queries *closest* and *any*: a program's rays in, its arrays filled.
// Shape   Chunk by chunk: rays to the scene's own space (local_rays.h), traced (session.h), hits to the
//         caller's arrays.
// Errors  As kdray/query.h says. What was written before an error is left.
// Threads As many calls at once as there are threads.
#pragma once

#include "kdray/query.h"
#include "prepare/prepared.h"
#include "query/geometry_table.h"
#include "query/local_rays.h"
#include "query/session.h"

namespace kdray::query {

// What is asked: a scene that is ready, and what its numbers mean.
struct Asked {
  const prepare::Prepared& scene;
  const GeometryTable& table;
  const LocalFrame& frame;
  Sessions& sessions;
};

QueryReport closest(const Asked& asked, const Rays& rays, const HitsOut& out, const QueryOptions& options);

// 1 for each ray that something lies in the way of, else 0.
QueryReport any(const Asked& asked, const Rays& rays, const BytesOut& out, const QueryOptions& options);

}  // namespace kdray::query
