// What    What a bench tells of a tree: how large it is, what a ray is expected to cost.
#pragma once

#include <cstddef>

#include "accel/prepare/prepared.h"

namespace kdray::bench {

struct TreeFacts {
  double duplication = 0;               // references for each primitive
  double sah_cost = 0, tight_cost = 0;  // as in kdtree::Statistics
  int max_depth = 0;
  std::size_t binary_bytes = 0, wide_bytes = 0;
};

inline TreeFacts facts_of(const prepare::Prepared& made) {
  return {.duplication = made.tree.duplication,
          .sah_cost = made.tree.sah_cost,
          .tight_cost = made.tree.tight_cost,
          .max_depth = made.tree.max_depth,
          .binary_bytes = made.flat.nodes.bytes() + made.flat.refs.bytes(),
          .wide_bytes = made.wide.bytes()};
}

}  // namespace kdray::bench
