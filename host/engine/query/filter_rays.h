// What    Rays as the filter of a scene of doubles takes them (primitives/triangle/filter.clh): in the
//         scene's own space, in floats, rounded once.
// Shape   A chunk of Rays -> layout::QueryRay. A ray from far off begins shortly before the scene. Eight at
//         a time, in the CPU's widest vectors (Highway); by itself what is out of the ordinary: a direction
//         much longer or shorter than 1, an origin beyond 2^20 times the scene's reach.
// Errors  Places and directions are off by u of themselves, and t_min and t_max lie outward of the true
//         ones by no more than 6u of themselves.
#pragma once

#include <cstddef>

#include "engine/query/local_rays.h"

namespace kdray::query {

// Fills out[0, n) with rays [first, first + n). Returns false where some mean nothing (check_rays.h); these
// meet nothing.
bool fill_filter_rays(const RayArrays& rays, const LocalFrame& frame, std::size_t first, std::size_t n,
                      layout::QueryRay* out);

}  // namespace kdray::query
