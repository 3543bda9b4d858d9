// What    Simulates ODPRT by discrete events: rays go from queue to queue, are served there one after
//         another, and lead to others when they end.
// Shape   A journey stands for `rays_per_journey` rays that stay together: they are a message of that many
//         rays, and are served in one go. A queue serves the deepest journey that waits, of equal ones the
//         first; eye rays all wait from the beginning, so they are begun when there is nothing else to do.
//         Ports are one for each direction and queue, and carry one message after another; the latency is
//         added on the way and holds up no one.
// Why     Events, not rounds: no barrier makes all queues wait for the slowest after every hop, so this is
//         what the division of the scene itself permits. Ties are broken by order of making: the same input
//         gives the same bits.
// Units   Seconds, bytes.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace kdray::bench {

// A stay with a queue.
struct Hop {
  std::uint32_t queue = 0;
  double seconds = 0;  // for all rays of the journey
};

struct Journey {
  std::vector<Hop> hops;            // at least one
  std::vector<std::uint32_t> next;  // journeys that begin where this one ends
  std::uint32_t depth = 1;
};

struct Network {
  double bytes_per_second = std::numeric_limits<double>::infinity();
  double latency = 0;
  double bytes_per_ray = 64;
};

struct Traffic {
  std::vector<Journey> journeys;
  std::vector<std::uint32_t> first;  // those that wait from the beginning, where their first hop is
  double rays_per_journey = 1;
};

struct Simulated {
  double seconds = 0;
  double busiest = 0;        // work of the queue that has the most
  double busiest_port = 0;   // seconds that the port with the most to carry is carrying
  double critical_path = 0;  // of the longest life, for a single ray that nothing holds up
  double rays_sent = 0;      // from queue to queue
};

Simulated simulate(const Traffic& traffic, std::uint32_t n_queues, const Network& network);

}  // namespace kdray::bench
