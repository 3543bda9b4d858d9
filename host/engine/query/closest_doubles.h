// What    Closest and any hits of a scene of doubles.
// Shape   Of many rays the device tells what floats are sure of (primitives/triangle/filter.clh); the host
//         looks at what is in doubt, and finds t, u and v of hits in double (double_scene.h). A call of few
//         rays is the host's alone.
// Errors  As of closest() and any().
#pragma once

#include "engine/query/queries.h"

namespace kdray::query {

QueryReport closest_of_doubles(const QueryContext& context, const RayArrays& rays, const HitsOut& out,
                               const QueryOptions& options);
QueryReport any_of_doubles(const QueryContext& context, const RayArrays& rays, const BytesOut& out,
                           const QueryOptions& options);

}  // namespace kdray::query
