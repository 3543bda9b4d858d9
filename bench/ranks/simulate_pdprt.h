// What    PDPRT by ranks in virtual time: pdprt's own Lender and Borrowers talk over transport::Network, and
//         queues that pretend (pretend_queue.h) are at work for what the tiles took in a measured frame.
// Shape   A rank's thread looks at its messages every so often, as crew.cpp does, and is occupied by each of
//         them; it looks only when something may have changed for it, which is the same. Ranks have a core
//         each, or share some (shared_cores.h).
// Errors  ErrorCode::internal: the protocol stands still.
#pragma once

#include <cstdint>

#include "bench/ranks/ping_pong.h"
#include "bench/ranks/pretend_queue.h"
#include "bench/ranks/shared_cores.h"
#include "transport/simulated.h"

namespace kdray::bench {

// What the ranks are, beside the frame.
struct RanksSetting {
  int ranks = 1;
  MessageCosts messages;
  double delay = 0;            // seconds that each message takes longer
  double look = 1e-3;          // between two looks at the messages
  bool moved_by_looks = true;  // long messages move only while somebody looks (ping_pong.h)
  SharedCores::Speed speed = [](std::size_t) { return 1.0; };
  std::uint64_t seed = 1;
};

// The network as the setting's ranks have it.
transport::Link link_of(const RanksSetting& setting);

struct SimulatedRanks {
  double seconds = 0;                      // of the frame, as rank 0 measures it
  double busy = 0;                         // of all queues together, in work
  double least_ready = 0, most_ready = 0;  // when the others were ready for tiles, after rank 0
  std::uint64_t messages = 0, bytes = 0;   // of rank 0, both ways
  std::size_t events = 0;
};

SimulatedRanks simulate_pdprt(const ReplayedFrame& frame, const RanksSetting& setting);

}  // namespace kdray::bench
