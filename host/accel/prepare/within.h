// What    Makes the tree coarser until what a device gets of the scene fits a number of bytes (--memory).
// Shape   Dearer inner nodes make larger leaves: fewer nodes, and fewer copies of primitives that lie in
//         several.
// Errors  ErrorCode::out_of_memory, with the least that the scene takes, where no tree fits.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "accel/kdtree/build.h"
#include "base/error.h"

namespace kdray::prepare {

inline std::string megabytes(std::uint64_t bytes) {
  return fmt::format("{:.1f}M", static_cast<double>(bytes) / (1 << 20));
}

// What `make` returns for a config has bytes(). `warning` says that the tree is coarser than asked for, and
// is left alone where it isn't.
template <class Make>
auto make_within(kdtree::BuildConfig config, std::uint64_t most_bytes, Make&& make, std::string& warning) {
  constexpr double kCoarsest = 256;
  config.cost_traverse = std::max(config.cost_traverse, 1.0);
  const double asked = config.cost_traverse, finest = config.group_traverse;
  for (double coarser = 1;; coarser *= 2) {
    config.cost_traverse = asked * coarser;
    config.group_traverse = finest * coarser;
    auto made = make(config);
    if (made.bytes() <= most_bytes) {
      if (coarser > 1)
        warning =
            fmt::format("the tree is coarser, so that the scene takes {} (--memory {}): tracing is slower",
                        megabytes(made.bytes()), megabytes(most_bytes));
      return made;
    }
    if (coarser >= kCoarsest)
      throw Error(ErrorCode::out_of_memory,
                  fmt::format("the scene takes {} at least; --memory {} is too little for it",
                              megabytes(made.bytes()), megabytes(most_bytes)));
  }
}

}  // namespace kdray::prepare
