// What    What messages cost on the network that there is: between the first two members of a team, while
//         nobody else does anything.
// Shape   Short and long messages there and back, for latency and bandwidth: medians. Many short ones in a
//         row, for what sending and taking one occupies a rank's thread: the least. Then messages of
//         several lengths between two who look only every millisecond, as ranks do: an MPI that moves long
//         ones only while somebody looks takes several looks for them.
// Units   Seconds; bytes a second.
#pragma once

#include "bench/ranks/team.h"

namespace kdray::bench {

struct MessageCosts {
  double latency = 0;  // one way
  double bandwidth = 1e12;
  double send = 0, take = 0;  // of a thread's time, for each message
  // Looks that a message of kMiddling or kLong bytes takes, beyond a short one's; and what goes through in
  // a look.
  double looks_of_middling = 0, looks_of_long = 0, bytes_of_look = 1e12;
};

inline constexpr std::size_t kMiddlingBytes = std::size_t{8} << 10, kLongBytes = std::size_t{256} << 10;

// All members call it; what member 0 gets is measured.
MessageCosts ping_pong(Team& team);

}  // namespace kdray::bench
