// What    Contestants against each other on one class of rays.
// Shape   A warm-up first, in which every variant of a contestant runs twice (once, when there is to be one
//         round) and its best is chosen; then rounds, in each
//         of which every contestant runs once: what slows the machine for a while slows all of them. Hits are
//         held against the reference in the warm-up, kdray's own in every round.
#pragma once

#include <span>
#include <vector>

#include "bench/measure/spread.h"
#include "bench/race/contestant.h"

namespace kdray::bench {

struct Outcome {
  Family family;
  std::string mode, variant;
  Spread seconds;
  double differing_share = 0;       // of rays, against the reference
  std::size_t n_not_identical = 0;  // kdray's own: the most in any run
};

std::vector<Outcome> race(const RayClass& rays, std::span<const Hit> reference,
                          const std::vector<Contestant>& contestants, int rounds);

// The fastest of a family; null when there is none.
const Outcome* best_of(std::span<const Outcome> outcomes, Family family);
// kdray's fastest fixed choice: all but "auto".
const Outcome* best_fixed(std::span<const Outcome> outcomes);
const Outcome* find(std::span<const Outcome> outcomes, Family family, std::string_view mode);

}  // namespace kdray::bench
