// What    The fast way for rays as nearly all are: floats, finite, with directions of ordinary length, not
//         from too far off.
// Shape   Same floats as LocalFrame::begin() gives.
#pragma once

#include "engine/query/local_rays.h"
#include "layout/rays.layout.h"

namespace kdray::query {

// Fills out[0, n) with rays [first, first + n) in the scene's own space. False, and `out` has anything, where
// one of them isn't such.
bool fill_plain_floats(const RayArrays& rays, const LocalFrame& frame, std::size_t first, std::size_t n,
                       layout::QueryRay* out);

}  // namespace kdray::query
