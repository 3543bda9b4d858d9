// What    How far one side's hits or answers are from another's, for the same rays or points.
#pragma once

#include <cstddef>
#include <span>

#include "bench/race/asker.h"
#include "kdray/kdray.h"

namespace kdray::bench {

// Rays that hit something.
std::size_t count_hits(std::span<const Hit> hits);

// Hits that are not the same bits (t, primitive, u, v).
std::size_t count_not_identical(std::span<const Hit> a, std::span<const Hit> b);

// The share of rays that one of them lets pass, or for which they name different primitives at distances that
// differ by more than 1e-4 of themselves: on a common edge both are right.
double differing_share(std::span<const Hit> a, std::span<const Hit> b);

// The same of scenes that number their primitives each in its own way: by distances alone.
double differing_distances(std::span<const Hit> a, std::span<const Hit> b);

// Of the answers [first, first + n); of `all` of those of the last call, which was about these. Another
// answer is: a hit where the other misses; for distances, those of all crossings too, one that is off by more
// than 1e-4 of itself and 1e-6 of `width`, the scene's; another number of crossings.
std::size_t count_differing(Question question, const Answers& a, const Answers& b, std::size_t first,
                            std::size_t n, double width);

}  // namespace kdray::bench
