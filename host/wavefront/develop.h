// What    From the film's 64-bit fixed-point sums (kernels/layout/frame.layout.h has the units) to linear RGB.
// Why     Integer addition is exact and has no order: bands, tiles and queues give the same bits.
#pragma once

#include <span>

#include "layout/frame.layout.h"
#include "math/vec.h"

namespace kdray::wavefront {

// The mean of `samples` samples for each of the pixels; three sums for each.
void develop(std::span<const layout::i64> sums, int samples, std::span<vec3> pixels);

}  // namespace kdray::wavefront
