#include "engine/checkpoint/render_round.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace kdray::checkpoint {

namespace {

constexpr std::size_t kLeastTiles = 4, kLeastRuns = 64;  // of a chunk: 64 runs are 16384 samples

using Entries = std::vector<layout::u32>;

Entries without(Entries all, Entries left) {
  std::ranges::sort(left);
  std::erase_if(all, [&](layout::u32 entry) { return std::ranges::binary_search(left, entry); });
  return all;
}

}  // namespace

Round round_of_tiles(const layout::Frame& frame, Entries curve, std::span<layout::i64> sums) {
  const Cut cut{frame.width, frame.height, frame.tile_width, frame.tile_height};
  return {.number = 0,
          .entries = std::move(curve),
          .places = [cut](layout::u32 tile) { return places_of(cut, 0, tile); },
          .pitch = frame.width,
          .sums = sums,
          .least_chunk = kLeastTiles};
}

Round round_of_runs(std::uint32_t number, std::size_t n_runs, std::span<layout::i64> sums) {
  Entries runs(n_runs);
  std::iota(runs.begin(), runs.end(), 0u);
  return {.number = number,
          .entries = std::move(runs),
          .places = [number](layout::u32 run) { return places_of({}, number, run); },
          .pitch = 0,
          .sums = sums,
          .least_chunk = kLeastRuns};
}

void render_round(FrameCheckpoint& checkpoint, Round round, const Stretches& stretches) {
  checkpoint.begin(std::move(round));
  for (Entries wanted = checkpoint.next(stretches.idle); !wanted.empty();
       wanted = checkpoint.next(stretches.idle)) {
    std::map<std::size_t, Entries> by_stretch;
    for (const layout::u32 entry : wanted) by_stretch[stretches.number_of(entry)].push_back(entry);
    for (const auto& [number, entries] : by_stretch) {
      Entries left = stretches.render(number, entries, checkpoint.seconds());
      const bool all = left.empty();
      checkpoint.keep(without(entries, std::move(left)));
      if (!all) break;  // the interval is over: what is next is asked anew
    }
  }
}

}  // namespace kdray::checkpoint
