// What    Finds the plane of least expected cost for a cell: exactly the minimum over all bounds of all
//         references, on three axes, with coplanar references on the cheaper side.
// Shape   A reference is below the plane s when lo < s, above it when hi > s, both when it straddles, and
//         planar when lo = hi = s.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/kdtree/build.h"
#include "accel/kdtree/exact/events.h"
#include "accel/kdtree/reference.h"
#include "accel/kdtree/sah.h"

namespace kdray::kdtree {

// Up to this many references all planes are counted against all references.
inline constexpr std::size_t kSmallSweep = 32;

// Memory that is kept from search to search; one per task.
struct SweepScratch {
  std::array<std::vector<Event>, 3> events;
};

// The best split, whatever it costs; not found() when no plane cuts the cell.
Split find_split(std::span<const BoundedRef> refs, const Bounds& cell, const BuildConfig& config,
                 SweepScratch& scratch);

// The two ways of finding it. small_sweep is quadratic and needs refs.size() <= kSmallSweep; sweep considers
// only planes that cost less than a leaf, since no other is taken.
Split small_sweep(std::span<const BoundedRef> refs, const Bounds& cell, const BuildConfig& config);
Split sweep(std::span<const BoundedRef> refs, const Bounds& cell, const BuildConfig& config,
            SweepScratch& scratch);

}  // namespace kdray::kdtree
