// What    What one sample in each pixel tells of the variance within the pixels: how far each differs from
//         what its neighbours would have it, were the picture smooth.
// Shape   The largest second difference d of the four lines through a pixel: 0 on any even slope, the whole
//         step beside an edge. An edge of that step somewhere between two centres gives a sample of one of
//         the two pixels a variance of d^2/6, or d^2/12 on average over both.
#pragma once

#include <span>

#include "engine/adaptive/blocks.h"
#include "layout/frame.layout.h"

namespace kdray::adaptive {

// `sums` has one sample of each pixel, in three channels; `variance` gets each pixel's, as the mean over the
// channels.
void contrast(std::span<const layout::i64> sums, Size size, std::span<float> variance);

}  // namespace kdray::adaptive
