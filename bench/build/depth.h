// What    `kdray bench depth`: the thesis' study of the maximum tree depth: what trees of every depth cost to
//         build, to hold and to trace.
// Shape   Depths from 0 in steps of 2 up to the usual one of the scene, then 4 and 8 beyond. Every round
//         makes each of the trees anew, traces the same rays over it and forgets it. A tree whose expected
//         cost is beyond kDearest is not
//         traced: it would take minutes.
// Errors  Those of scene::load and Renderer. Hits that differ between depths are counted, not thrown.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/build/bench.h"
#include "kdray/kdray.h"

namespace kdray::bench {

inline constexpr double kDearest = 1000;  // of TreeFacts::tight_cost

struct DepthOptions {
  std::vector<std::string> scenes = {"boxes", "balls", "rings", "displaced"};
  BuildQuality quality = BuildQuality::balanced;
  int rays = 1 << 16;  // of a class, at the most
  int repeat = 3;      // rounds
  std::string device = "auto";
};

struct DepthRow {
  int max_depth = 0;  // that was allowed; TreeFacts has what was reached
  BuildSpreads seconds;
  std::optional<Spread> trace_seconds;  // for a million rays of each class
  TreeFacts tree;
  std::size_t n_not_identical = 0;  // hits that are not those of the usual depth
};

struct DepthRun {
  std::string scene, device;
  std::size_t n_primitives = 0;
  int usual_depth = 0;
  std::vector<DepthRow> rows;
};

std::vector<DepthRun> bench_depth(const DepthOptions& options,
                                  const std::function<void(const DepthRun&)>& done,
                                  const std::function<void(const std::string&)>& working);

// The depths for a scene whose usual one is this.
std::vector<int> depths_to_try(int usual);

std::size_t count_not_identical(std::span<const DepthRun> runs);

}  // namespace kdray::bench
