// What    Ranks over a network that is only computed, with latency, bandwidth and reordering from a seed; and
//         a real transport that is held back as if its network were slower, so that runs can be measured with
//         a delay where the system has no means for it (docs/logbook/ranks.md).
// Shape   A Network has the clock and all that is on its way. Whoever drives it moves the clock on to the
//         next message or to a moment of its own, and lets ranks act. A rank's messages leave one after the
//         other, each for its length at the bandwidth; then it travels for the latency and up to `jitter`
//         times that more, so that a later one may overtake it. The same calls with the same seed give the
//         same messages at the same times.
//         delayed() hands a message over `latency` after it has come, and not before those that came earlier
//         have taken their time at the bandwidth; jitter adds to the latency as above.
// Units   Seconds, virtual ones in a Network; bytes a second.
// Threads One.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <queue>
#include <random>
#include <vector>

#include "cluster/transport/transport.h"

namespace kdray::transport {

// Ranks that are threads of one process. Tests run whole frames over them. Each rank has an inbox. A rank
// may end at any time; what is sent to it after that is lost.
std::vector<std::unique_ptr<Transport>> in_process(int ranks);

struct Link {
  double latency = 50e-6;                                      // seconds, one way
  double jitter = 0;                                           // times the latency
  double bandwidth = std::numeric_limits<double>::infinity();  // bytes a second, of what a rank sends
};

class Network {
 public:
  Network(int ranks, const Link& link, std::uint64_t seed);

  Transport& rank(int number) { return *ranks_[static_cast<std::size_t>(number)]; }
  int ranks() const { return static_cast<int>(ranks_.size()); }
  double now() const { return now_; }

  // Returns when the next message arrives; infinity: none is on its way.
  double next_arrival() const;
  // Moves the clock on to a moment that is not before now; messages that arrive until then can be polled.
  void advance(double to);

 private:
  friend class Simulated;
  struct OnItsWay {
    double arrives;
    std::uint64_t number;  // makes the order of what comes at one moment the same each time
    int to;
    std::shared_ptr<Message> message;
    bool operator>(const OnItsWay& other) const {
      return arrives != other.arrives ? arrives > other.arrives : number > other.number;
    }
  };

  void post(int from, int to, Tag tag, Bytes bytes);

  Link link_;
  std::mt19937_64 random_;
  double now_ = 0;
  std::uint64_t n_posted_ = 0;
  std::priority_queue<OnItsWay, std::vector<OnItsWay>, std::greater<>> on_their_way_;
  std::vector<double> free_at_;  // when a rank's link is
  std::vector<std::queue<Message>> inboxes_;
  std::vector<std::unique_ptr<Transport>> ranks_;
};

// Returns the transport with its messages held back.
std::unique_ptr<Transport> delayed(std::unique_ptr<Transport> transport, const Link& link,
                                   std::uint64_t seed = 1);

}  // namespace kdray::transport
