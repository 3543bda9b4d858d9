// What    The exact builder: every cell is split at the least of all planes' costs; large cells by all
//         threads together, subtrees in one thread each.
// Shape   Where a subtree begins depends on the number of references only, so threads never show in the tree.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "accel/kdtree/build.h"
#include "accel/kdtree/fragment.h"
#include "accel/kdtree/reference.h"
#include "accel/kdtree/sah.h"

namespace kdray::kdtree {

// Finds the plane to split a cell at: the one of least expected cost, which is exactly the minimum over all
// bounds of all references, on three axes, with coplanar references on the cheaper side; or, for
// comparison, a median of the thesis, which looks at no costs. A reference is below the plane s when lo <
// s, above it when hi > s, both when it straddles, and planar when lo = hi = s. Source: Wald and Havran
// 2006, section 4.2 (events); Kaplan 1985 (spatial median); Bentley 1975 (object median).

// Up to this many references all planes are counted against all references.
inline constexpr std::size_t kSmallSweep = 32;

// The events of the plane sweep: where references end, lie and start along an axis, as sortable integers. The
// upper bits keep the order of float positions, the lowest two are the kind of the event: at one position
// ends come first, then planar references, then starts.
using Event = std::uint64_t;
enum class EventKind : std::uint32_t { end = 0, planar = 1, start = 2 };

inline Event make_event(float position, EventKind kind) {
  // + 0 turns -0 into 0: they are one plane.
  const auto bits = std::bit_cast<std::uint32_t>(position + 0.0f);
  const std::uint32_t ordered = bits & 0x80000000u ? ~bits : bits | 0x80000000u;
  return static_cast<Event>(ordered) << 2 | static_cast<std::uint32_t>(kind);
}

inline EventKind kind_of(Event e) {
  return static_cast<EventKind>(e & 3u);
}

inline float position_of(Event e) {
  const auto ordered = static_cast<std::uint32_t>(e >> 2);
  return std::bit_cast<float>(ordered & 0x80000000u ? ordered & 0x7fffffffu : ~ordered);
}

// Memory that is kept from search to search; one for each task.
struct SweepScratch {
  std::array<std::vector<Event>, 3> events;
};

// Returns the best split, whatever it costs; not found() when no plane cuts the cell.
Split find_split(std::span<const BoundedRef> refs, const Bounds& cell, const BuildConfig& config,
                 SweepScratch& scratch);

// The two ways of finding it. small_sweep is quadratic and needs refs.size() <= kSmallSweep; sweep considers
// only planes that cost less than a leaf, since no other is taken.
Split small_sweep(std::span<const BoundedRef> refs, const Bounds& cell, const BuildConfig& config);
Split sweep(std::span<const BoundedRef> refs, const Bounds& cell, const BuildConfig& config,
            SweepScratch& scratch);

// The median splits make a leaf of kMedianLeaf references or fewer, one full block of the wide form, and
// where no plane of the rule separates anything.
inline constexpr std::size_t kMedianLeaf = 8;

// `rule` says which median; it must not be SplitRule::sah.
Split median_split(std::span<const BoundedRef> refs, const Bounds& cell, SplitRule rule);

// What is handed down with a cell.
struct CellState {
  Bounds cell;
  int depth = 0;
  double budget = 0;  // references that the leaves below it may have in all; at least those of the cell
};

// Returns the state with the cell that costs are computed over: the contents' bounds, with
// BuildConfig::tight_cells.
CellState tightened(const CellState& state, std::span<const BoundedRef> refs, const BuildConfig& config);

// `refs` are all primitives' references, `bounds` their hull.
std::unique_ptr<TopNode> build_exact(const scene::Geometry& geometry, const BuildConfig& config,
                                     int max_depth, std::vector<BoundedRef>&& refs, const Bounds& bounds);

}  // namespace kdray::kdtree
