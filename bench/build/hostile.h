// What    `kdray bench build --hostile`: building over meshes made to break a builder, each against a plain
//         mesh (a displaced sphere) of as many triangles in the same rounds.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/race/build_race.h"
#include "kdray/kdray.h"

namespace kdray::bench {

struct HostileOptions {
  std::vector<std::string> meshes = {};  // empty: all
  int triangles = 1000000;
  int repeat = 5;
  BuildQuality quality = BuildQuality::balanced;
};

struct HostileResult {
  std::string mesh, what;
  std::size_t n_triangles = 0;  // that are left when degenerate ones have been dropped
  std::size_t n_plain_triangles = 0;
  BuildSpreads seconds, plain_seconds;
  double duplication = 0, plain_duplication = 0;  // references for each primitive
  std::size_t wide_bytes = 0, plain_wide_bytes = 0;
  double tight_cost = 0, plain_tight_cost = 0;  // as in kdtree::Statistics
  std::uint32_t largest_leaf = 0;
  int max_depth = 0;
  double times_plain() const { return seconds.total.median / plain_seconds.total.median; }
};

// `done` hears of every mesh as soon as it has been measured, `working` what is being measured.
std::vector<HostileResult> bench_hostile(const HostileOptions& options,
                                         const std::function<void(const HostileResult&)>& done,
                                         const std::function<void(const std::string&)>& working);

}  // namespace kdray::bench
