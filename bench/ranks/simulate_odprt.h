// What    ODPRT by ranks in virtual time: odprt's own Exchange, ledger of rays, Post and Ending talk over
//         transport::Network, and queues that pretend (pretend_worker.h) send the lives of a frame's rays.
// Shape   As band.cpp: a rank's thread looks at the post every so often, its queue takes turns. A frame is
//         one band; it begins when rank 0 has told the others, and ends when their sums are with rank 0.
// Errors  ErrorCode::internal: the protocol stands still.
#pragma once

#include "bench/ranks/pretend_worker.h"
#include "bench/ranks/simulate_pdprt.h"

namespace kdray::bench {

struct SimulatedOdprt {
  double seconds = 0, busy = 0;
  std::uint64_t rays_sent = 0;
  std::uint64_t messages = 0, bytes = 0;  // of rank 0, both ways
  std::size_t events = 0;
};

// `frame` is divided among the setting's ranks.
SimulatedOdprt simulate_odprt(const LivedFrame& lived, const DividedFrame& frame, const OdprtCosts& costs,
                              const RanksSetting& setting);

}  // namespace kdray::bench
