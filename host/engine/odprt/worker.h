// What    One queue of ODPRT on its device: its slices' pools and streams, its film, and the part of the
//         scene that it serves at the moment. It does what it is told; who sends what to whom is decided in
//         exchange.h.
// Shape   Slice s of every worker handles the rays of the pixels whose tiles are slice s's in the list of the
//         worker that makes their eye rays: within a worker no two slices touch one pixel. Each worker has a
//         film of all the band's pixels; their sums add up to the picture.
// Errors  cl::Error and kdray::Error of the device; counters are handed out for the caller to check.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "device/opencl/context.h"
#include "device/opencl/kernel.h"
#include "engine/odprt/outbox.h"
#include "engine/odprt/plan.h"
#include "engine/odprt/subtrees.h"
#include "engine/wavefront/programs.h"
#include "engine/wavefront/scene_buffers.h"
#include "engine/wavefront/slice_buffers.h"
#include "engine/wavefront/stage.h"
#include "layout/frame.layout.h"
#include "layout/odprt.layout.h"

namespace kdray::odprt {

// The stages of ODPRT's waves where every ray has a work-item (kernels/odprt/stages): a launch for each
// stage of each wave. The rays of a queue are one slice's.
class RayStages {
 public:
  // Builds the programs, for features with numbers; `work_group` is the local size of all launches.
  RayStages(wavefront::Programs& programs, layout::Features features, std::size_t work_group);

  // Calls `act` with every stage that is there.
  template <class Do>
  void for_each(const Do& act) {
    act(plan_), act(admit_), act(trace_), act(shade_), act(receive_);
    if (shadow_) act(*shadow_);
  }

  // Launches waves of a frame's batch size, whose shadow rays come in rounds of its light batch. What they
  // send goes into the outbox.
  void launch(cl::CommandQueue& queue, const layout::Frame& frame, std::uint32_t n_waves,
              std::uint32_t n_tiles, const Outbox& outbox);
  // Launches what takes the rays of a place of an outbox, whose counts have been read.
  void receive(cl::CommandQueue& queue, const Outbox& outbox, std::uint32_t place);

  // The device's seconds so far, by the names that the stages of slices have.
  std::map<std::string, double> seconds();

 private:
  void launch_lights(cl::CommandQueue& queue, const layout::Frame& frame);

  const std::size_t work_group_;
  wavefront::Stage<kernels::TravelPlan> plan_;
  wavefront::Stage<kernels::TravelAdmit> admit_;
  wavefront::Stage<kernels::TravelTrace> trace_;
  wavefront::Stage<kernels::TravelShade> shade_;
  std::optional<wavefront::Stage<kernels::TravelShadow>> shadow_;  // in scenes with lights
  wavefront::Stage<kernels::TravelReceive> receive_;
};

// A part on a device.
struct LoadedPart {
  std::uint32_t number = 0, n_shared = 0;
  bool replicates = false;  // the division does
  wavefront::SceneBuffers scene;
  cl::Buffer subtrees;  // a cell for each, for the census
  std::uint32_t n_subtrees = 0;
};

// What is rendered between two clearings of the film: tiles of a band of the picture, or runs of samples
// (frame.layout.h).
struct Work {
  std::size_t first_pixel = 0, n_places = 0;  // of the film
  std::span<const layout::u32> samples = {};  // empty: tiles
};

// The most of it that fits.
struct WorkCapacity {
  std::size_t places = 0, entries = 0, samples = 0;
};

class Worker {
 public:
  Worker(const device::Context& context, cl::CommandQueue queue, wavefront::Programs& programs,
         const layout::Frame& frame, const BufferPlan& plan, layout::Features features, Traversal traversal,
         std::size_t work_group, std::span<const layout::PartCell> directory, const WorkCapacity& capacity,
         std::size_t max_subtrees);
  ~Worker();
  Worker(const Worker&) = delete;

  const device::Context& context() const { return context_; }

  // Clears the film.
  void begin(const Work& work);
  // Entries (tiles, or runs of samples) whose eye rays the worker is to make, behind those that it has.
  void add(std::span<const layout::u32> entries);
  // About how many of them a launch begins.
  std::uint32_t launch_tiles() const;

  // `census_every`: visits to the part's subtrees are counted in one wave of so many; 0: in none.
  void serve(const LoadedPart& part, std::uint32_t census_every);

  // PoCL compiles a kernel for good at its first launch: here one that finds nothing to do, not in the
  // frame's time.
  void warm_up(const LoadedPart& part, Outbox& outbox);

  // Takes the rays that a place of an outbox of this context has into the pools.
  void receive(const Outbox& outbox, std::uint32_t place);
  // Takes as many of these rays as fit; returns how many.
  std::uint64_t receive(HostRayQueue& host_rays);

  // One launch: up to n_waves waves of each slice. What it sends is in `outbox`, whose counts are read back.
  void launch(std::span<const layout::Credits> credits, Outbox& outbox);
  // Waits for what has been received without a launch.
  void finish();

  // Takes everything that waits out of the pools.
  void stash(HostRayQueue& host_rays);

  // What the last launch left.
  std::span<const layout::Slice> slices() const { return slices_; }
  std::span<const layout::Traffic> traffic() const { return traffic_; }
  std::uint32_t tiles_left() const;  // not begun
  std::uint64_t n_waiting() const;   // rays in the pools
  std::vector<SubtreeUse> visits() const;

  // Calls take(sums) with the film's, three for each place, which are there until it returns.
  void with_film(const std::function<void(std::span<const layout::i64>)>& take);

  // Copies what an outbox of this queue has to where the rays of the parts that it goes to wait; nullptr: not
  // that part's.
  void copy_out(const Outbox& outbox, const std::function<HostRayQueue*(std::uint32_t)>& host_rays_of);

  // Adds what the stages took in the band: cycles of slices, else seconds.
  void add_stages(std::map<std::string, double>& times);

  std::size_t bytes() const { return bytes_; }
  double busy_seconds();

 private:
  cl::Buffer make(std::size_t bytes, const char* what);
  template <class Do>
  void for_each_stage(const Do& act);
  template <class K>
  void set_arguments(wavefront::Stage<K>& stage);
  void launch_waves(const Outbox& outbox);

  const device::Context& context_;
  cl::CommandQueue queue_;
  layout::Frame frame_;
  const BufferPlan plan_;
  layout::Travel travel_{};
  WorkCapacity capacity_;
  std::size_t bytes_ = 0, n_places_ = 0;
  bool in_runs_ = false;  // the entries are runs of samples
  std::vector<layout::u32> list_;
  std::vector<layout::Slice> slices_;
  std::vector<layout::Traffic> traffic_;
  std::vector<layout::u32> visits_;
  wavefront::SliceBuffers buffers_;
  cl::Buffer travel_buffer_, cells_, credit_buffer_, traffic_buffer_, shadow_pool_, visit_buffer_;
  std::vector<std::vector<float>>
      stashed_;   // what is being read of the pools: here, since after an error a read may go on
  Outbox inbox_;  // of one part: rays from the host's memory
  // Slices' waves in one launch; or their stages, where every ray has a work-item.
  std::optional<wavefront::Stage<kernels::TravelWave>> wave_;
  std::optional<wavefront::Stage<kernels::Receive>> receive_;
  std::optional<RayStages> stages_;
};

}  // namespace kdray::odprt
