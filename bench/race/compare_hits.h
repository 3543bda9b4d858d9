// What    How far one tracer's hits are from another's, for the same rays.
#pragma once

#include <cstddef>
#include <span>

#include "kdray/kdray.h"

namespace kdray::bench {

// Hits that are not the same bits (t, primitive, u, v).
std::size_t count_not_identical(std::span<const Hit> a, std::span<const Hit> b);

// The share of rays that one of them lets pass, or for which they name different primitives at distances that
// differ by more than 1e-4 of themselves: on a common edge both are right.
double differing_share(std::span<const Hit> a, std::span<const Hit> b);

// The same of scenes that number their primitives each in its own way: by distances alone.
double differing_distances(std::span<const Hit> a, std::span<const Hit> b);

}  // namespace kdray::bench
