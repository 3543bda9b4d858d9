// What    What `kdray info` tells about a tree: shape, duplication, expected cost.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/kdtree/build.h"

namespace kdray::kdtree {

struct Statistics {
  std::uint64_t inner_nodes = 0, leaves = 0, empty_leaves = 0,
                references = 0;  // a leaf is a cell, in groups or whole
  std::uint64_t groups = 0;      // that cells are divided into
  // [k] = leaves of k references, the last entry: that many or more.
  std::vector<std::uint64_t> leaves_by_size;
  std::uint32_t largest_leaf = 0;
  int max_depth = 0;
  double mean_leaf_depth = 0;
  double duplication = 0;  // references / primitives
  double sah_cost = 0;     // expected cost of a ray that hits the bounds, in units of BuildConfig's constants
  // The same of a walk that skips what lies outside of each node's contents, as the wide form's do.
  double tight_cost = 0;
};

Statistics measure(const Tree& tree, const scene::Geometry& geometry, const BuildConfig& config = {});

}  // namespace kdray::kdtree
