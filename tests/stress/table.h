// What    The stress suite's results: how many rays each family may spend, and the table of what came out,
//         printed when the program ends and written as JSON.
// Shape   KDRAY_STRESS: unset, the quick part; "full" or a number, about that many traced rays for the leaks
//         and as many for the re-hits, and shares of it for queries. KDRAY_STRESS_JSON: a file for the table.
#pragma once

#include <cstdint>
#include <string>

namespace kdray::stress {

// One family with one traversal: `wrong` is what must be 0.
struct Row {
  std::string figure, family, traversal;
  std::uint64_t rays = 0, wrong = 0;
  std::uint64_t exceptions = 0;  // what docs/design/stress.md excepts, counted all the same
};

// The worst errors of a family against exact arithmetic.
struct Errors {
  std::string family;
  std::uint64_t samples = 0;
  double t_ulps = 0;  // of t itself
  // The largest error of t, in ulps of the largest number in play, where the ray meets the surface at 45
  // degrees or more.
  double t_facing_ulps = 0;
  // The hit point's distance from the surface, in ulps of its largest coordinate in play.
  double point_ulps = 0;
  double share_of_bound = 0;  // that distance over what the kernels allow for it: must stay below 1
};

void add(const Row& row);
void add(const Errors& errors);

bool is_full();

// Traced rays for a part of the leaks or of the re-hits; `share` of the whole.
std::uint64_t rays_to_trace(double share);

}  // namespace kdray::stress
