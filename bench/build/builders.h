// What    kdray's builders by name: the qualities of --build, and those of the thesis that only the bench
//         has.
// Source  The thesis' chapter 5: perfect, boxed, spatial median and object median.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "accel/kdtree/build.h"

namespace kdray::bench {

struct Builder {
  std::string name;
  kdtree::BuildConfig config;
};

// fast, balanced, best; for a scene of n primitives.
std::vector<Builder> quality_builders(std::size_t n_primitives);

// "perfect" (costs over cells, with flat and empty ones), "boxed" (bounds are split, primitives are not
// clipped), "spatial median", "object median".
std::vector<Builder> thesis_builders(std::size_t n_primitives);

}  // namespace kdray::bench
