// What    PDPRT: renders a frame with its pixels divided among the queues of any number of devices, each of
//         which sees the whole scene.
// Shape   The tiles of a band (the whole frame, unless its film is too large for a queue) along a curve; a
//         thread for each queue takes tiles (tiles.h), keeps its queue's list filled, and puts the queue's
//         tiles into the picture. Each queue has a film of its own; the one that took a tile last owns it.
//         With ranks, rank 0 has the bag (tile_server.h), and the others get theirs from it (tile_client.h).
// Errors  A queue whose device fails, or has too little memory, is left alone from then on: the others render
//         the tiles that it has not delivered. The error of the last queue, when all fail. Any other error
//         ends the frame (device/opencl/opencl_error.h).
// Source  T. V. Christensen, "Parallel Ray Tracing", DTU 2009: pixel-distributed, bag of tasks.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "cluster/transport/ranks.h"
#include "engine/frame/driver.h"
#include "engine/frame/result.h"
#include "engine/pdprt/tile_hierarchy.h"
#include "engine/pdprt/tiles.h"
#include "engine/wavefront/wavefront.h"

namespace kdray::pdprt {

// The queues of one context, and what they share. All devices' schedules have the same tiles.
struct Device {
  const device::Context* context;
  const wavefront::SceneBuffers* scene;
  wavefront::Programs* programs;
  wavefront::Schedule schedule;
};

// Stands for a tile that no queue of this process has rendered: it was found in a checkpoint.
inline constexpr std::uint32_t kNobody = 0xffffffffu;

// Samples of one round of adaptive sampling that a queue's film has space for at least, so that small
// pictures don't take many lists for one.
inline constexpr std::size_t kLeastSamples = std::size_t{1} << 18;

// Its frame is without a schedule (flatten::make_frame). The timeline also asks for Result::tile_seconds.
struct Task : frame::Request {
  Division division = Division::bag;
  std::size_t max_film_bytes = std::size_t{256} << 20;  // per queue; larger pictures go in bands
  // Others that render the same frame; rank 0 has the picture then, and the others' result has none. Null:
  // there are none.
  transport::Ranks* ranks = nullptr;
  Hash shared_frame = {};  // the same for all of them, and for no other frame (checkpoint::Header::frame())
  int ranks_to_a_bag = kRanksToABag;  // the same for all of them; beyond that there are several
};

struct QueueResult : frame::QueueReport {
  std::uint64_t tiles = 0;       // that are in the picture, as are its rays
  std::string failure;           // empty: none
  std::uint64_t tiles_lost = 0;  // that it had taken when it failed
};

struct Result : frame::Result {
  std::vector<QueueResult> queues;
  TileCost tile_cost;                      // no total: it was not measured
  std::vector<double> tile_seconds;        // of a compute unit, in the order of the curve, band after band
  std::vector<std::uint32_t> tile_queues;  // by row and column of tiles: who rendered it, or kNobody
};

Result render(std::span<const Device> devices, const Task& task);

}  // namespace kdray::pdprt
