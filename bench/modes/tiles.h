// What    Simulates PDPRT: how long queues take for tiles of known costs. The picture's gathering is left
//         out.
// Shape   Contiguous and interleaved queues know their tiles and never wait. A bag is at one place: the
//         request for a tile and the answer take the link's latency each, and the bag serves requests one
//         after another, each for `service` seconds. A queue asks so early that it need not wait for the
//         answer, where its tiles are that long.
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

// The same picture in larger and larger tiles, down to one: four that follow each other to one, as they lie
// together along the curve that tiles come in.
std::vector<std::vector<double>> tile_sizes(std::vector<double> tiles);

}  // namespace kdray::bench
