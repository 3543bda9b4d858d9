// What    What messages cost on the network that there is (ranks/bench.h).
#include <algorithm>
#include <chrono>
#include <thread>

#include "base/timer.h"
#include "bench/ranks/bench.h"

namespace kdray::bench {

namespace {

using transport::Bytes, transport::Transport;

constexpr transport::Tag kBall = 0;
constexpr std::size_t kShort = 32, kLong = std::size_t{1} << 20;
constexpr int kShortTrips = 400, kLongTrips = 40, kInARow = 500, kRows = 9;
constexpr double kMostBandwidth = 1e12;  // that of threads, which copy nothing

void take_one(Transport& with) {
  while (!with.poll()) std::this_thread::yield();
}

// The median of a trip there and back, of the first; the second's is nobody's.
double trip(Transport& with, std::size_t bytes, int n) {
  std::vector<double> seconds;
  for (int i = 0; i < n; ++i) {
    const Timer timer;
    if (with.rank() == 1) take_one(with);
    with.send(1 - with.rank(), kBall, Bytes(bytes, '.'));
    if (with.rank() == 0) take_one(with);
    seconds.push_back(timer.seconds());
  }
  return median(seconds);
}

// What the first sends in a row lies ready when the second begins to take it.
void row(Transport& with, std::vector<double>& send, std::vector<double>& take) {
  const Timer timer;
  if (with.rank() == 0) {
    for (int i = 0; i < kInARow; ++i) with.send(1, kBall, Bytes(kShort, '.'));
    send.push_back(timer.seconds() / kInARow);
    take_one(with);
  } else {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const Timer taking;
    for (int i = 0; i < kInARow; ++i) take_one(with);
    take.push_back(taking.seconds() / kInARow);
    with.send(0, kBall, Bytes(kShort, '.'));
  }
}

}  // namespace

MessageCosts ping_pong(Team& team) {
  MessageCosts costs;
  team.meet();
  std::vector<double> send, take;
  if (const auto with = team.group(2); with && team.size() > 1) {
    const double short_trip = trip(*with, kShort, kShortTrips), long_trip = trip(*with, kLong, kLongTrips);
    costs.latency = short_trip / 2;
    costs.bandwidth = std::min(
        kMostBandwidth, static_cast<double>(kLong - kShort) / std::max((long_trip - short_trip) / 2, 1e-9));
    for (int i = 0; i < kRows; ++i) row(*with, send, take);
  }
  const auto least = [](const std::vector<double>& v) {
    return v.empty() ? 0 : *std::ranges::min_element(v);
  };
  costs.send = least(send);
  const std::vector<double> takes = team.gather(least(take));
  if (takes.size() > 1) costs.take = takes[1];
  return costs;
}

}  // namespace kdray::bench
