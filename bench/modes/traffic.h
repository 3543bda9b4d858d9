// What    The journeys of a sample's rays from queue to queue, for events.h, by the rules of ODPRT
//         (kernels/odprt).
// Shape   Eye rays begin with the queue that they enter first, or, where they enter none, on queues in turn;
//         others where their parent ended. A ray asks the queues whose cells it enters, in the order in which
//         it first does, each once: for all that it holds on the ray's way (that ODPRT traces a ray where it
//         is made, before another is asked, is left out: there it meets little). A shadow ray ends with the
//         first that finds something in its way; another ray asks all that it enters before its hit, then
//         goes back to the one that found it, where it is shaded. The directory is walked by whoever has the
//         ray, and so is what every queue holds: what is hit there is shaded there.
// Limits  A queue that is asked doesn't know a hit that another will find, and may walk on behind it: that is
//         left out.
#pragma once

#include "bench/modes/events.h"
#include "bench/modes/paths.h"

namespace kdray::bench {

// What the parts of a single ray's life cost.
struct Rates {
  double seconds_of_cost = 0;   // of a path's unit
  double seconds_of_shade = 0;  // of a hit
};

// `paths` are those of the lives, by queues.
Traffic make_traffic(std::span<const LifeRay> lives, const Paths& paths, std::uint32_t n_queues,
                     const Rates& rates, double rays_per_journey);

}  // namespace kdray::bench
