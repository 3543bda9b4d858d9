// What    What messages cost on the network that there is: between the first two members of a team, while
//         nobody else does anything.
// Shape   Short and long messages there and back, for latency and bandwidth: medians. Many short ones in a
//         row, for what sending and taking one occupies a rank's thread: the least.
// Units   Seconds; bytes a second.
#pragma once

#include "bench/ranks/team.h"

namespace kdray::bench {

struct MessageCosts {
  double latency = 0;  // one way
  double bandwidth = 1e12;
  double send = 0, take = 0;  // of a thread's time, for each message
};

// All members call it; what member 0 gets is measured.
MessageCosts ping_pong(Team& team);

}  // namespace kdray::bench
