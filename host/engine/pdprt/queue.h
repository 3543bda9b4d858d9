// What    One of PDPRT's queues: takes tiles, keeps the device supplied with them, and puts them into the
//         picture.
// Shape   A queue has tiles for a few launches ahead, by the waves that its tiles have taken so far: enough
//         that its slices don't run dry, and little enough that others don't wait for it at the end.
// Threads One serves a queue; queues share Tiles and the picture, of which each writes its own tiles.
#pragma once

#include <atomic>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "base/timer.h"
#include "device/opencl/clock.h"
#include "engine/pdprt/render.h"
#include "engine/pdprt/tiles.h"

namespace kdray::pdprt {

// What a list's tiles are: the picture's, of which the film begins with `first_pixel`, or runs of samples
// (frame.layout.h).
struct Work {
  const frame::Sink& sink;  // of the tiles that are done: each is handed over by one queue's thread
  std::size_t first_pixel = 0;
  std::span<const layout::u32> samples = {};  // empty: tiles
  // A queue delivers what it has when a list has taken so long, and begins another.
  double seconds = std::numeric_limits<double>::infinity();
  // When the tiles that nobody has taken are left: no queue takes more than it will have done by then.
  double left_after = std::numeric_limits<double>::infinity();
};

// What the queues of a frame share.
struct Shared {
  std::atomic<std::uint64_t> tiles_done{0};
  std::vector<double> tile_seconds;        // by row and column of tiles; empty: not wanted
  std::vector<std::uint32_t> tile_queues;  // likewise: the queue whose tile is in the picture
};

class Queue {
 public:
  // Throws kdray::Error when the device can't.
  Queue(std::size_t number, const Device& device, const cl::CommandQueue& queue, const Task& task,
        const wavefront::Capacity& capacity);

  // Renders tiles until all of them are in the picture, those of the other queues too, or someone has left.
  void serve(Tiles& tiles, const Work& work, Shared& shared);

  // Takes back what it has told Shared::tiles_done of tiles that it will not deliver.
  void withdraw(Shared& shared);

  const wavefront::Wavefront& wavefront() const { return wavefront_; }
  std::uint64_t tiles() const { return n_tiles_; }  // in the picture
  const TileCost& tile_cost() const { return tile_cost_; }

 private:
  std::optional<std::span<const layout::u32>> more(Tiles& tiles, const wavefront::Progress& progress,
                                                   const Work& work, Shared& shared);
  std::size_t tiles_of_launch() const;

  std::size_t shortest_launch(const wavefront::Progress& progress) const;
  void deliver(std::span<const layout::u32> tiles, const Work& work, Shared& shared);
  void note_costs(std::span<const layout::u32> tiles, Shared& shared);

  std::size_t number_;
  layout::Frame frame_;
  std::uint32_t n_slices_;
  double waves_per_launch_, waves_per_tile_;  // the latter as measured so far, and no less than this:
  double least_waves_per_tile_ = 0;           // since empty tiles take none
  std::uint32_t compute_units_;
  std::optional<device::Clock> clock_;
  wavefront::Wavefront wavefront_;
  // These are about the present list.
  std::uint64_t n_told_ = 0;  // of tiles_done
  double busy_before_ = 0;
  Timer since_begin_;
  std::uint64_t n_tiles_ = 0;
  TileCost tile_cost_;
};

}  // namespace kdray::pdprt
