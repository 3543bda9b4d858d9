// What    The queries of points: *closest point*, *inside* and *signed distance*, from a program's arrays
//         to its arrays.
// Errors  As kdray/query.h says.
// Threads As many calls at once as there are threads.
#pragma once

#include "engine/query/ask.h"
#include "kdray/query.h"

namespace kdray::query {

QueryReport closest_points(const QueryContext& context, const Points& points, const ClosestPointsOut& out,
                           const PointOptions& options);

QueryReport inside(const QueryContext& context, const Points& points, const BytesOut& out,
                   const PointOptions& options);

QueryReport signed_distance(const QueryContext& context, const Points& points, const ValuesOut& out,
                            const PointOptions& options);

}  // namespace kdray::query
