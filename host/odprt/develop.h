// What    The films of several queues -> linear RGB: the sums of each pixel added up, then divided by its
//         samples.
#pragma once

#include <span>

#include "layout/frame.layout.h"
#include "math/vec.h"

namespace kdray::odprt {

// Each film has three sums for each pixel. Adding saturates, as it does in the kernels.
void develop(std::span<const std::span<const layout::i64>> films, int samples, std::span<vec3> pixels);

// The sums alone, added up.
void add_up(std::span<const std::span<const layout::i64>> films, std::span<layout::i64> sums);

}  // namespace kdray::odprt
