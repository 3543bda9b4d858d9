// What    Simulates PDPRT: how long queues take for tiles of known costs. The picture's gathering is left out.
// Shape   Contiguous and interleaved queues know their tiles and never wait. A bag is at one place: a queue asks for its next
//         tile when it begins one, the request and the answer take the link's latency each, and the bag serves requests one
//         after another, each for `service` seconds.
// Units   Seconds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace kdray::bench {

struct BagLink {
  double latency = 0, service = 0;
};

double contiguous_seconds(std::span<const double> tiles, std::uint32_t n_queues);
double interleaved_seconds(std::span<const double> tiles, std::uint32_t n_queues);
double bag_seconds(std::span<const double> tiles, std::uint32_t n_queues, const BagLink& link);

// Larger tiles: four that follow each other to one, as they lie together along the curve that tiles come in; as long as each
// of the queues still has `least` of them.
std::vector<double> joined(std::vector<double> tiles, std::uint32_t n_queues, std::uint32_t least);

}  // namespace kdray::bench
