// What    A transport as if its network were slower: what comes is held back, so that real runs can be
//         measured with a delay where the system has no means for it (docs/logbook/ranks.md).
// Shape   A message that comes is handed over `latency` later, and not before those that came earlier have
//         taken their time at the bandwidth.
// Units   Seconds; bytes a second.
#pragma once

#include <memory>

#include "transport/simulated.h"

namespace kdray::transport {

// Of `link`, latency and bandwidth count.
std::unique_ptr<Transport> delayed(std::unique_ptr<Transport> transport, const Link& link);

}  // namespace kdray::transport
