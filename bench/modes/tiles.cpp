#include "bench/modes/tiles.h"

#include <algorithm>
#include <queue>

namespace kdray::bench {

namespace {

struct Request {
  double time;
  std::size_t number;
  std::uint32_t queue;
  bool operator>(const Request& other) const {
    return time != other.time ? time > other.time : number > other.number;
  }
};

}  // namespace

double contiguous_seconds(std::span<const double> tiles, std::uint32_t n_queues) {
  double longest = 0;
  for (std::uint64_t q = 0; q < n_queues; ++q) {
    double taken = 0;
    for (std::size_t i = q * tiles.size() / n_queues; i < (q + 1) * tiles.size() / n_queues; ++i)
      taken += tiles[i];
    longest = std::max(longest, taken);
  }
  return longest;
}

double interleaved_seconds(std::span<const double> tiles, std::uint32_t n_queues) {
  std::vector<double> taken(n_queues);
  for (std::size_t i = 0; i < tiles.size(); ++i) taken[i % n_queues] += tiles[i];
  return *std::max_element(taken.begin(), taken.end());
}

double bag_seconds(std::span<const double> tiles, std::uint32_t n_queues, const BagLink& link) {
  std::priority_queue<Request, std::vector<Request>, std::greater<>> requests;
  for (std::uint32_t q = 0; q < n_queues; ++q) requests.push({0, q, q});
  std::vector<double> busy_until(n_queues);
  const double way = 2 * link.latency + link.service;
  double bag_free = 0, end = 0;
  std::size_t n_requests = n_queues;
  for (const double seconds : tiles) {
    const Request request = requests.top();
    requests.pop();
    bag_free = std::max(bag_free, request.time + link.latency) + link.service;
    double& until = busy_until[request.queue];
    const double start = std::max(bag_free + link.latency, until);
    until = start + seconds;
    end = std::max(end, until);
    requests.push({std::max(start, until - way), n_requests++, request.queue});
  }
  return end;
}

std::vector<std::vector<double>> tile_sizes(std::vector<double> tiles) {
  std::vector<std::vector<double>> sizes{std::move(tiles)};
  while (sizes.back().size() > 1) {
    const std::vector<double>& smaller = sizes.back();
    std::vector<double> larger((smaller.size() + 3) / 4);
    for (std::size_t i = 0; i < smaller.size(); ++i) larger[i / 4] += smaller[i];
    sizes.push_back(std::move(larger));
  }
  return sizes;
}

}  // namespace kdray::bench
