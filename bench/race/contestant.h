// What    Someone who traces a class of rays and says how long it took: a traversal of kdray's, a mode of
//         Embree's.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/workload/rays.h"

namespace kdray::bench {

struct Traced {
  double seconds = 0;  // wall time, the rays lying ready in the layout that the tracer takes
  std::vector<Hit> hits;
};

enum class Family { kdray, embree_fast, embree_robust };

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

}  // namespace kdray::bench
