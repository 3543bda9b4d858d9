#include "accel/kdtree/exact/split.h"

namespace kdray::kdtree {

Split find_split(std::span<const BoundedRef> refs, const Bounds& cell, const BuildConfig& config,
                 SweepScratch& scratch) {
  // A cell without area is met by almost no ray, and its costs are 0/0.
  if (refs.empty() || !(half_area(cell) > 0)) return {};
  return refs.size() <= kSmallSweep ? small_sweep(refs, cell, config) : sweep(refs, cell, config, scratch);
}

}  // namespace kdray::kdtree
