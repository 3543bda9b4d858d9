// What    The vectorised parts of the binned builder, compiled for several instruction sets and chosen at run
//         time.
// Shape   Results are the same bits at every vector width: lanes never meet but in minima, and ties go to the
//         smaller axis, then to the smaller position.
// Source  Popov, Guenther, Seidel, Slusallek, "Experiences with streaming construction of SAH kd-trees", RT
//         2006 (bins); Wald and Havran, RT 2006 (clipping); docs/logbook/kdtree.md for what was measured.
#pragma once

#include <span>
#include <vector>

#include "accel/kdtree/binned/bin_grid.h"
#include "accel/kdtree/binned/sweep_buffers.h"
#include "accel/kdtree/build.h"
#include "accel/kdtree/fragment.h"
#include "accel/kdtree/reference.h"
#include "scene/model/geometry.h"

namespace kdray::kdtree::binned {

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

// Memory that is kept from task to task; one per thread.
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

// The best of the planes between bins for a cell of n references, of which every sample_stride(n)-th was
// counted, where it is cheaper than a leaf.
Plane best_plane(const BinCounts& counts, const BinGrid& grid, const Bounds& contents, std::size_t n,
                 const BuildConfig& config);

// How many references are on neither side of the plane.
std::size_t n_straddling(std::span<const BoundedRef> refs, const Plane& plane);

// Leaves the references' parts below the plane in front of `refs`, behind which there is room for one more,
// and those above it in workspace.above.
Divided divide(const scene::Geometry& geometry, const BuildConfig& config, std::span<BoundedRef> refs,
               const Plane& plane, Workspace& workspace);

// Hull of the references' bounds.
Bounds fast_hull_of(std::span<const BoundedRef> refs);

// Appends the references of a cell that is not divided by a plane, as a leaf or as groups; leaves them in
// another order.
void append_groups(std::span<BoundedRef> refs, const Bounds& contents, int depth, const BuildConfig& config,
                   Fragment& out);

// Builds the subtree over the first n references of the workspace's stack, which has more than n; the result
// is workspace.fragment.
void build_subtree(const scene::Geometry& geometry, const BuildConfig& config, int max_depth, std::size_t n,
                   const Cell& cell, Workspace& workspace);

}  // namespace kdray::kdtree::binned
