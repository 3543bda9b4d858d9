// What    A transport as if its network were slower: what comes is held back, so that real runs can be
//         measured with a delay where the system has no means for it (docs/logbook/ranks.md).
// Shape   A message that comes is handed over `latency` later, and not before those that came earlier have
//         taken their time at the bandwidth; with jitter, up to so many times the latency later, by a seed,
//         so that messages overtake each other.
// Units   Seconds; bytes a second.
#pragma once

#include <memory>

#include "cluster/transport/simulated.h"

namespace kdray::transport {

std::unique_ptr<Transport> delayed(std::unique_ptr<Transport> transport, const Link& link,
                                   std::uint64_t seed = 1);

}  // namespace kdray::transport
