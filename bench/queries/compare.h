// What    How many answers of one asker's are others than another's, for the same rays or points.
#pragma once

#include "bench/race/asker.h"

namespace kdray::bench {

// Of the answers [first, first + n); of `all` of those of the last call, which was about these. Another
// answer is: a hit where the other misses; for distances, those of all crossings too, one that is off by more
// than 1e-4 of itself and 1e-6 of `width`, the scene's; another number of crossings.
std::size_t count_differing(Question question, const Answers& a, const Answers& b, std::size_t first,
                            std::size_t n, double width);

}  // namespace kdray::bench
