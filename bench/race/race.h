// What    Contestants against each other on one class of rays: a traversal of kdray's, a mode of Embree's.
// Shape   A warm-up first, in which every variant of a contestant runs twice (once, when there is to be one
//         round) and its best is chosen; then rounds, in each of which every contestant runs once: what slows
//         the machine for a while slows all of them. Hits are held against the reference in the warm-up,
//         kdray's own in every round.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/measure/report.h"
#include "bench/workload/rays.h"

namespace kdray::bench {

struct Traced {
  double seconds = 0;  // wall time, the rays lying ready in the layout that the tracer takes
  std::vector<Hit> hits;
};

enum class Family { kdray, embree_fast, embree_robust };

const char* name_of(Family family);  // "Embree fast"

// A way of tracing that can be set for the rays at hand: Embree's flag for coherent rays.
struct Variant {
  std::string name;  // empty where there is but one
  std::function<Traced(const RayClass&)> trace;
};

struct Contestant {
  Family family;
  std::string mode;                 // "packet", "16", "stream"
  std::vector<Variant> variants;    // the best of them counts
  std::vector<Hit> reference = {};  // that its hits are held against; empty: the race's
};

struct Outcome {
  Family family;
  std::string mode, variant;
  Spread seconds;
  double differing_share = 0;       // of rays, against the reference
  std::size_t n_not_identical = 0;  // kdray's own: the most in any run
};

// kdray's traversals: binary, wide, packet, batch, auto.
std::span<const std::string_view> traversal_names();
Traversal traversal_of(std::string_view name);

// Its time is the one that Renderer::statistics() gives: rays and scene already on the device.
Contestant kdray_contestant(const std::shared_ptr<Renderer>& renderer, const std::string& traversal);

// Without the names of contestant and family.
Json json_of(const Outcome& outcome, std::size_t n_rays);

std::vector<Outcome> race(const RayClass& rays, std::span<const Hit> reference,
                          const std::vector<Contestant>& contestants, int rounds);

// The fastest of a family; null when there is none.
const Outcome* best_of(std::span<const Outcome> outcomes, Family family);
// kdray's fastest fixed choice: all but "auto".
const Outcome* best_fixed(std::span<const Outcome> outcomes);
const Outcome* find(std::span<const Outcome> outcomes, Family family, std::string_view mode);

}  // namespace kdray::bench
