// What    The queries: a program's rays or points in, its arrays filled.
// Shape   Chunk by chunk, on all places at once (shared_rows.h): rays to the scene's own space
//         (local_rays.h), traced (session.h, passes.h) or looked up (point_session.h), answers to the
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

// Closest and any hits (closest.cpp).
QueryReport closest(const QueryContext& context, const Rays& rays, const HitsOut& out,
                    const QueryOptions& options);

// Writes 1 for each ray that something lies in the way of, else 0.
QueryReport any(const QueryContext& context, const Rays& rays, const BytesOut& out,
                const QueryOptions& options);

// How many surfaces rays cross, and all of these crossings (crossings.cpp).
QueryReport count(const QueryContext& context, const Rays& rays, const WordsOut& out,
                  const QueryOptions& options);

AllHits all(const QueryContext& context, const Rays& rays, const AllHitsOptions& options);

// Of points (points.cpp).
QueryReport closest_points(const QueryContext& context, const Points& points, const ClosestPointsOut& out,
                           const PointOptions& options);

QueryReport inside(const QueryContext& context, const Points& points, const BytesOut& out,
                   const PointOptions& options);

QueryReport signed_distance(const QueryContext& context, const Points& points, const ValuesOut& out,
                            const PointOptions& options);

}  // namespace kdray::query
