#include "bench/ranks/ping_pong.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "base/median.h"
#include "base/timer.h"
#include "bench/measure/spread.h"

namespace kdray::bench {

namespace {

using transport::Bytes, transport::Transport;

constexpr transport::Tag kBall = 0;
constexpr std::size_t kShort = 32, kLong = std::size_t{1} << 20;
constexpr int kShortTrips = 400, kLongTrips = 40, kInARow = 500, kRows = 9;
constexpr int kLookedTrips = 30, kStream = 32;
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

// The mean time between looks of somebody who naps for a millisecond.
class Looking {
 public:
  explicit Looking(Transport& with) : with_(with) {}
  void take_one() {
    while (!look()) nap();
  }
  bool look() {
    ++n_looks_;
    return with_.poll().has_value();
  }
  void nap() {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ++n_naps_;
  }
  double naps() const { return n_naps_; }

 private:
  Transport& with_;
  double n_looks_ = 0, n_naps_ = 0;
};

// As trip(), in looks: one way.
double looks_of_trip(Transport& with, std::size_t bytes) {
  Looking looking(with);
  std::vector<double> looks;
  for (int i = 0; i < kLookedTrips; ++i) {
    const double before = looking.naps();
    if (with.rank() == 1) looking.take_one();
    with.send(1 - with.rank(), kBall, Bytes(bytes, '.'));
    if (with.rank() == 0) looking.take_one();
    looks.push_back((looking.naps() - before) / 2);
  }
  return sum(looks) / kLookedTrips;
}

// Looks until many long messages have gone to the first; 0 of the second.
double looks_of_stream(Transport& with) {
  Looking looking(with);
  if (with.rank() == 1) {
    looking.take_one();
    for (int i = 0; i < kStream; ++i) with.send(0, kBall, Bytes(kLongBytes, '.'));
    looking.take_one();
    return 0;
  }
  with.send(1, kBall, Bytes(kShort, '.'));
  for (int n = 0; n < kStream; looking.nap())
    for (; n < kStream && looking.look();) ++n;
  with.send(1, kBall, Bytes(kShort, '.'));
  return looking.naps();
}

void look_now_and_then(Transport& with, MessageCosts& costs) {
  const double of_short = looks_of_trip(with, kShort), of_middling = looks_of_trip(with, kMiddlingBytes),
               of_long = looks_of_trip(with, kLongBytes);
  costs.looks_of_middling = std::max(0.0, of_middling - of_short);
  costs.looks_of_long = std::max(0.0, of_long - of_short);
  const double looks = looks_of_stream(with) - 1 - of_long;
  costs.bytes_of_look = static_cast<double>(kStream) * kLongBytes / std::max(looks, 1e-3);
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
    look_now_and_then(*with, costs);
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
