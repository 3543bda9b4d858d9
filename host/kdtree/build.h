// What    Builds the kd-tree by the surface-area heuristic with perfect splits (primitives clipped to the cell),
//         O(N log N), parallel over subtrees; the same tree for any number of threads.
// Source  Wald and Havran, "On building fast kd-trees for ray tracing, and on doing that in O(N log N)", RT 2006;
//         Havran's thesis (2000) for clipping and empty space. Flat cells are allowed.
#pragma once

#include "kdtree/tree.h"

namespace kdray::kdtree {

struct BuildConfig {
  double cost_traverse = 1.0;   // Ct: one inner node
  double cost_intersect = 1.5;  // Ci: one primitive test
  double empty_bonus = 0.8;     // lambda: a split that cuts off empty space costs this share
  int max_depth = -1;           // -1: 8 + 1.3*log2(N)
  bool clip = true;             // false: split the references' boxes only ("boxed" of the thesis)
};

Tree build(const scene::Geometry& geometry, const BuildConfig& config = {});

}  // namespace kdray::kdtree
