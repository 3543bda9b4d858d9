// What    The binned builder: the top of the tree level by level with all threads at work on every level,
//         then subtrees, the largest first, each in one thread. Its vectorised parts (simd.cpp) are compiled
//         for several instruction sets and chosen at run time.
// Shape   The tree is the same for any number of threads and on any instruction set: what is chosen depends
//         on the references and their order alone. Lanes never meet but in minima, and ties go to the smaller
//         axis, then to the smaller position.
// Source  Popov, Guenther, Seidel, Slusallek, "Experiences with streaming construction of SAH kd-trees", RT
//         2006 (bins); Wald and Havran, RT 2006 (clipping); docs/logbook/kdtree.md for what was measured.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "accel/kdtree/build.h"
#include "accel/kdtree/fragment.h"
#include "accel/kdtree/reference.h"
#include "accel/kdtree/tree.h"
#include "scene/model/geometry.h"

namespace kdray::kdtree::binned {

// ---- Bins: 32 equal ones along each axis of a cell's contents, and how many references begin and end in
// each. Beginnings are counted from the lower end and ends from the upper one, both rounded towards their
// end: a bound on the plane between two bins then counts as a partition by that plane treats it. Counts may
// be off by one where rounding moves a bound across a plane: they choose a plane and decide nothing else.

inline constexpr int kBins = 32;

// In a cell of n references every stride-th is counted: some hundreds show as well where to split as all of
// them do.
inline std::size_t sample_stride(std::size_t n) {
  constexpr std::size_t kEnough = 512, kMost = 32;
  return std::clamp<std::size_t>(std::bit_floor(n / kEnough), 1, kMost);
}

struct BinGrid {
  // The fourth lane is computed with the reference's number, whose bits may be a denormal float: these values
  // keep the results from being denormal.
  alignas(16) std::array<float, 4> lo{0, 0, 0, 1}, hi{0, 0, 0, 1}, scale{0, 0, 0, 0};

  float plane(int axis, int bin) const {
    const auto k = static_cast<std::size_t>(axis);
    return lo[k] + (hi[k] - lo[k]) * (static_cast<float>(bin) / kBins);
  }
};

inline BinGrid make_bin_grid(const Bounds& contents) {
  BinGrid grid;
  for (std::size_t k = 0; k < 3; ++k) {
    grid.lo[k] = contents.lo[k];
    grid.hi[k] = contents.hi[k];
    const float scale = kBins / (grid.hi[k] - grid.lo[k]);
    // A very thin axis is one bin.
    grid.scale[k] = scale > 0 && scale < 1e37f ? scale : 0;
  }
  return grid;
}

struct BinCounts {
  alignas(64) std::array<std::array<std::uint32_t, kBins>, 3> begins{};
  alignas(64) std::array<std::array<std::uint32_t, kBins>, 3> ends{};

  void add(const BinCounts& other) {
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t b = 0; b < kBins; ++b) {
        begins[k][b] += other.begins[k][b];
        ends[k][b] += other.ends[k][b];
      }
  }
};

// ---- Memory for parting one cell's references into groups (sweep-inl.h): written before it is read, for
// each cell anew.

// Cells of up to so many references are swept; larger ones are first parted between steps.
inline constexpr std::size_t kSwept = 512;

struct SweepBuffers {
  static constexpr std::size_t kPadded = kSwept + 32;  // vectors may reach beyond the last
  using Corner = std::array<float, 4>;                 // x, y, z, and a lane that nothing reads

  // The references' bounds relative to the cell's longest edge, and their centres in steps of 16 bits.
  alignas(64) std::array<Corner, kSwept> lo, hi;
  alignas(64) std::array<std::array<std::int16_t, kPadded>, 3> center;

  // The references by their centres along each axis.
  alignas(64) std::array<std::array<std::uint16_t, kSwept>, 3> order;

  // Edges of the hulls of a group's first i references along an axis, and of the others.
  using Edges = std::array<Corner, kPadded>;
  alignas(64) Edges first, second;

  // What a test of i references costs, and of kSwept - i.
  alignas(64) std::array<float, kPadded> tests, tests_backward;

  alignas(64) std::array<std::int16_t, kPadded> ranks;
  std::array<std::uint16_t, kSwept> ties, others;
  std::array<std::uint8_t, kSwept> is_second;

  // The nodes of the groups, before they go to the fragment.
  std::array<Node, 2 * kSwept> nodes;
  std::array<Box, 2 * kSwept> contents;
  std::array<Ref, kSwept> refs;
  std::size_t n_nodes, n_refs;

  // Writes nothing, where the arrays' own constructors would write the members' initialisers.
  SweepBuffers() {}  // NOLINT
};

// ---- The vectorised parts

// A cell before it is built.
struct Cell {
  Bounds contents;  // hull of its references
  int depth = 0;
  double budget = 0;  // references that the leaves below it may have in all
};

struct Plane {
  int axis = -1;  // -1: a leaf is as cheap
  float position = 0;
  bool found() const { return axis >= 0; }
};

// Memory that is kept from task to task; one for each thread.
struct Workspace {
  std::vector<BoundedRef> stack, straddlers, above, others;
  Fragment fragment;
  SweepBuffers sweep;
};

// How far a piece of a cell's references was divided.
struct Divided {
  std::size_t n_below = 0, n_above = 0;
};

// Adds the bins of every stride-th reference to the counts.
void count(std::span<const BoundedRef> refs, const BinGrid& grid, std::size_t stride, BinCounts& counts);

// Returns the best of the planes between bins for a cell of n references, of which every sample_stride(n)-th
// was counted, where it is cheaper than a leaf.
Plane best_plane(const BinCounts& counts, const BinGrid& grid, const Bounds& contents, std::size_t n,
                 const BuildConfig& config);

// Counts the references that are on neither side of the plane.
std::size_t n_straddling(std::span<const BoundedRef> refs, const Plane& plane);

// Leaves the references' parts below the plane in front of `refs`, behind which there is space for one more,
// and those above it in workspace.above.
Divided divide(const scene::Geometry& geometry, const BuildConfig& config, std::span<BoundedRef> refs,
               const Plane& plane, Workspace& workspace);

// Returns the hull of the references' bounds.
Bounds fast_hull_of(std::span<const BoundedRef> refs);

// Appends the references of a cell that is not divided by a plane, as a leaf or as groups; leaves them in
// another order.
void append_groups(std::span<BoundedRef> refs, const Bounds& contents, int depth, const BuildConfig& config,
                   Fragment& out);

// Builds the subtree over the first n references of the workspace's stack, which has more than n; the result
// is workspace.fragment.
void build_subtree(const scene::Geometry& geometry, const BuildConfig& config, int max_depth, std::size_t n,
                   const Cell& cell, Workspace& workspace);

// ---- The builder

// Builds the tree's top and its subtrees. `bounds` becomes the hull of all primitives, of which there is at
// least one.
std::unique_ptr<TopNode> build_binned(const scene::Geometry& geometry, const BuildConfig& config,
                                      int max_depth, Bounds& bounds);

}  // namespace kdray::kdtree::binned
