// What    Builds the kd-tree by the surface-area heuristic with perfect splits (primitives clipped to the
//         cell), O(N log N), parallel over subtrees; the same tree for any number of threads.
// Source  Wald and Havran, "On building fast kd-trees for ray tracing, and on doing that in O(N log N)", RT
//         2006; Havran's thesis (2000) for clipping and empty space. Flat cells are allowed.
#pragma once

#include "accel/kdtree/tree.h"

namespace kdray::kdtree {

// How much time goes into a tree; docs/logbook/kdtree.md has what each costs and gains.
enum class Quality {
  fast,      // as balanced, but inner nodes count double: larger leaves, sooner
  balanced,  // planes between bins, and exact ones near the best of them, on cells as tight as their contents
  best,      // the best of all planes, primitives clipped to the whole cell
};

// How the place of a split is chosen. The medians are the thesis' (chapter 5), for the bench; the exact
// builder knows all three, the binned one only the heuristic.
enum class SplitRule { sah, spatial_median, object_median };

struct BuildConfig {
  Quality quality = Quality::balanced;
  SplitRule split_rule = SplitRule::sah;
  double cost_traverse = 1.0;   // Ct: one inner node
  double cost_intersect = 2.0;  // Ci: one test, of `block` primitives
  int block = 1;  // primitives tested at once, a power of two: a leaf of n costs Ci*ceil(n/block)
  // Costs are those of the contents' bounds; false: of the cell's, as in the thesis (exact builder).
  bool tight_cells = true;
  double empty_bonus = 0.6;  // lambda: with loose cells, a split that cuts off empty space costs this share
  // What is in a cell is divided further, by primitives (binned/group-inl.h). Cells are then larger, unless
  // they are to stay as small as without: for the binary form, whose walk tests all that a cell holds.
  bool groups = false;
  bool small_cells = false;
  double group_traverse = 0.8;  // a division into groups, where a test costs 1, of which
  double group_each = 0.5;  // this share is each primitive's, and the rest its block's; 0: blocks stay whole
  int max_depth = -1;       // -1: 8 + 1.3*log2(N)
  bool clip = true;         // false: split the references' boxes only ("boxed" of the thesis)
};

// Returns what Ct is multiplied by. Dearer inner nodes make larger leaves and fewer references.
double traverse_factor(Quality quality);

// Sets the groups that suit the wide form's walks for a scene of n primitives (docs/design/kdtree.md): few
// primitives for a clutter of large and small ones, whole blocks for fine meshes, where walks wait for
// memory, and for trees that are built fast or have small cells.
BuildConfig suited(BuildConfig config, std::size_t n_primitives);

// Returns the depth of the deepest leaf that a tree of n primitives may have: what the config says, up to the
// traversal's stack.
int depth_limit(const BuildConfig& config, std::size_t n_primitives);

Tree build(const scene::Geometry& geometry, const BuildConfig& config = {});

}  // namespace kdray::kdtree
