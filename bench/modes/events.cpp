#include "bench/modes/events.h"

#include <algorithm>
#include <queue>
#include <span>

namespace kdray::bench {

namespace {

// A journey at one of its hops.
struct Stop {
  std::uint32_t journey = 0, hop = 0;
};

struct Event {
  double time;
  std::uint64_t number;
  bool arrives;  // else it has been served
  Stop stop;
  bool operator>(const Event& other) const {
    return time != other.time ? time > other.time : number > other.number;
  }
};

struct Waiting {
  std::uint32_t depth;
  std::uint64_t number;
  Stop stop;
  bool operator<(const Waiting& other) const {
    return depth != other.depth ? depth < other.depth : number > other.number;
  }
};

struct Queue {
  std::priority_queue<Waiting> waiting;
  bool busy = false;
  double work = 0;
  double out_free = 0, in_free = 0;  // ports
  double out_used = 0, in_used = 0;
};

class Simulation {
 public:
  Simulation(const Traffic& traffic, std::uint32_t n_queues, const Network& network)
      : traffic_(traffic),
        network_(network),
        queues_(n_queues),
        message_seconds_(traffic.rays_per_journey * network.bytes_per_ray / network.bytes_per_second) {}

  Simulated run() {
    for (const std::uint32_t journey : traffic_.first) wait({journey, 0});
    for (std::size_t q = 0; q < queues_.size(); ++q) serve(queues_[q], 0);
    while (!events_.empty()) {
      const Event event = events_.top();
      events_.pop();
      outcome_.seconds = event.time;
      event.arrives ? arrive(event) : leave(event);
    }
    for (const Queue& q : queues_) {
      outcome_.busiest = std::max(outcome_.busiest, q.work);
      outcome_.busiest_port = std::max({outcome_.busiest_port, q.out_used, q.in_used});
    }
    return outcome_;
  }

 private:
  const Hop& at(const Stop& stop) const { return traffic_.journeys[stop.journey].hops[stop.hop]; }

  void wait(const Stop& stop) {
    queues_[at(stop).queue].waiting.push({traffic_.journeys[stop.journey].depth, n_++, stop});
  }

  void serve(Queue& queue, double now) {
    if (queue.busy || queue.waiting.empty()) return;
    const Stop stop = queue.waiting.top().stop;
    queue.waiting.pop();
    queue.busy = true;
    queue.work += at(stop).seconds;
    events_.push({now + at(stop).seconds, n_++, false, stop});
  }

  void arrive(const Event& event) {
    wait(event.stop);
    serve(queues_[at(event.stop).queue], event.time);
  }

  void leave(const Event& event) {
    const Journey& journey = traffic_.journeys[event.stop.journey];
    const std::uint32_t here = at(event.stop).queue;
    if (event.stop.hop + 1 < journey.hops.size()) {
      send(here, {event.stop.journey, event.stop.hop + 1}, event.time);
    } else {
      for (const std::uint32_t next : journey.next) send(here, {next, 0}, event.time);
    }
    queues_[here].busy = false;
    serve(queues_[here], event.time);
  }

  void send(std::uint32_t from, const Stop& stop, double now) {
    const std::uint32_t to = at(stop).queue;
    if (to == from) {
      wait(stop);
      return;
    }
    Queue &sender = queues_[from], &receiver = queues_[to];
    sender.out_free = std::max(sender.out_free, now) + message_seconds_;
    const double begins = std::max(sender.out_free - message_seconds_ + network_.latency, receiver.in_free);
    receiver.in_free = begins + message_seconds_;
    sender.out_used += message_seconds_, receiver.in_used += message_seconds_;
    outcome_.rays_sent += traffic_.rays_per_journey;
    events_.push({receiver.in_free, n_++, true, stop});
  }

  const Traffic& traffic_;
  const Network& network_;
  std::vector<Queue> queues_;
  double message_seconds_;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  std::uint64_t n_ = 0;  // of events and of waiting journeys, in the order of their making
  Simulated outcome_;
};

// The longest life from this journey on, for one ray by itself. Journeys come before those that they lead to.
double critical_path(const Traffic& traffic, const Network& network) {
  const double hop_seconds = network.latency + network.bytes_per_ray / network.bytes_per_second;
  std::vector<double> longest(traffic.journeys.size());
  double all = 0;
  for (std::size_t i = traffic.journeys.size(); i-- > 0;) {
    const Journey& journey = traffic.journeys[i];
    for (const std::uint32_t next : journey.next) {
      const bool sent = traffic.journeys[next].hops.front().queue != journey.hops.back().queue;
      longest[i] = std::max(longest[i], longest[next] + (sent ? hop_seconds : 0));
    }
    for (const Hop& hop : journey.hops) longest[i] += hop.seconds / traffic.rays_per_journey;
    longest[i] += hop_seconds * static_cast<double>(journey.hops.size() - 1);
    all = std::max(all, longest[i]);
  }
  return all;
}

}  // namespace

Simulated simulate(const Traffic& traffic, std::uint32_t n_queues, const Network& network) {
  Simulated outcome = Simulation(traffic, n_queues, network).run();
  outcome.critical_path = critical_path(traffic, network);
  return outcome;
}

}  // namespace kdray::bench
