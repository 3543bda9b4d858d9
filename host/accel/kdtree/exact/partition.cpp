#include "accel/kdtree/exact/partition.h"

#include <tbb/parallel_for.h>

#include "accel/kdtree/clip.h"

namespace kdray::kdtree {

namespace {

constexpr std::size_t kChunk = 8192;  // references to a parallel task

enum class Side { below, above, both };

Side side_of(const BoundedRef& r, const Split& split) {
  const float lo = r.lo[split.axis], hi = r.hi[split.axis];
  if (lo == split.position && hi == split.position) return split.planar_below ? Side::below : Side::above;
  if (hi <= split.position) return Side::below;
  return lo >= split.position ? Side::above : Side::both;
}

}  // namespace

std::size_t partition(const scene::Geometry& geometry, const BuildConfig& config, const Bounds& cell,
                      const Split& split, std::span<BoundedRef> refs, std::vector<BoundedRef>& below_refs) {
  std::size_t n_above = 0;
  for (const BoundedRef r : refs) {
    switch (side_of(r, split)) {
      case Side::below:
        below_refs.push_back(r);
        break;
      case Side::above:
        refs[n_above++] = r;
        break;
      case Side::both: {
        const SplitBounds parts = config.clip ? clip_to_sides(geometry, r, cell, split.axis, split.position)
                                              : SplitBounds{below(r.bounds(), split.axis, split.position),
                                                            above(r.bounds(), split.axis, split.position)};
        if (!parts.below.empty()) below_refs.push_back(with_bounds(r, parts.below));
        if (!parts.above.empty()) refs[n_above++] = with_bounds(r, parts.above);
        break;
      }
    }
  }
  return n_above;
}

Sides partition_large(const scene::Geometry& geometry, const BuildConfig& config, const Bounds& cell,
                      const Split& split, std::vector<BoundedRef>&& refs) {
  const std::size_t n_chunks = (refs.size() + kChunk - 1) / kChunk;
  std::vector<std::vector<BoundedRef>> below_parts(n_chunks);
  std::vector<std::size_t> n_above(n_chunks), first_below(n_chunks + 1, 0), first_above(n_chunks + 1, 0);
  tbb::parallel_for(std::size_t{0}, n_chunks, [&](std::size_t c) {
    const std::span<BoundedRef> part =
        std::span(refs).subspan(c * kChunk, std::min(kChunk, refs.size() - c * kChunk));
    n_above[c] = partition(geometry, config, cell, split, part, below_parts[c]);
  });
  for (std::size_t c = 0; c < n_chunks; ++c) {
    first_below[c + 1] = first_below[c] + below_parts[c].size();
    first_above[c + 1] = first_above[c] + n_above[c];
  }
  Sides sides;
  sides.below.resize(first_below[n_chunks]);
  sides.above.resize(first_above[n_chunks]);
  tbb::parallel_for(std::size_t{0}, n_chunks, [&](std::size_t c) {
    std::copy(below_parts[c].begin(), below_parts[c].end(), sides.below.begin() + first_below[c]);
    std::copy_n(refs.begin() + c * kChunk, n_above[c], sides.above.begin() + first_above[c]);
  });
  refs = {};
  return sides;
}

}  // namespace kdray::kdtree
