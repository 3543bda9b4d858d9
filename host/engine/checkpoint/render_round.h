// What    What modes have in common when they render a frame of which a checkpoint is kept: the rounds of
//         tiles and of samples, and the way through a round, a stretch of it (what a queue's film has places
//         for) at a time.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "engine/checkpoint/frame_checkpoint.h"
#include "layout/frame.layout.h"

namespace kdray::checkpoint {

// All tiles of the frame, of which `curve` has the order; `sums` are the picture's.
Round round_of_tiles(const layout::Frame& frame, std::vector<layout::u32> curve, std::span<layout::i64> sums);

// All runs of a list of samples; `sums` has three for each.
Round round_of_runs(std::uint32_t number, std::size_t n_runs, std::span<layout::i64> sums);

struct Stretches {
  std::function<std::size_t(layout::u32 entry)> number_of;  // of the stretch that the entry lies in
  // Renders entries of a stretch, for `seconds` or a little longer. Returns those that it has left out.
  std::function<std::vector<layout::u32>(std::size_t stretch, std::vector<layout::u32> entries,
                                         double seconds)>
      render;
  std::function<void()> idle = {};  // called while others are waited for
};

void render_round(FrameCheckpoint& checkpoint, Round round, const Stretches& stretches);

}  // namespace kdray::checkpoint
