// What    Traces tiles of a frame on one queue, wave by wave: admit, trace closest, shade, trace shadow, add;
//         in one launch for all stages (CPUs) or in one for each.
// Shape   Fused, n_slices slices, each with a pool, a batch and shadow rays of its own
//         (kernels/raygen/admit.clh has the bound on the pool). The queue's work is a list of tiles on the
//         device, which grows: slice s takes the entries s, s + n_slices, ... as far as it goes. A wave
//         serves all slices. Not fused, there is one slice, and each ray of its batch has a work-item in
//         every stage. The next launch, and more tiles for it, are queued before the host looks at what the
//         last one left: the device never waits for the host, and runs one empty launch at the end.
// Errors  Counters are read after every launch: a full stack or pool, or a NaN, ends the render with
//         ErrorCode::internal, since the picture would be wrong. Whatever OpenCL says leaves as another code.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "device/opencl/read_back.h"
#include "engine/wavefront/counters.h"
#include "engine/wavefront/programs.h"
#include "engine/wavefront/scene_buffers.h"
#include "engine/wavefront/slice_buffers.h"
#include "engine/wavefront/stage.h"
#include "layout/frame.layout.h"

namespace kdray::wavefront {

// How a frame is cut up for the device. A choice changes time and memory, never the picture.
struct Schedule {
  std::uint32_t tile_width = 32, tile_height = 32;
  std::uint32_t batch_size = 512;  // rays a slice traces in one wave
  std::uint32_t n_slices = 64;     // slices in flight on a queue, if stages are fused
  std::uint32_t light_batch = 8;   // lights between two waves of shadow rays, KDRAY_MAX_LIGHT_BATCH at most
  // All stages in one launch (for CPUs); false: one launch per stage, and every ray has a work-item.
  bool fused = true;
  std::uint32_t fused_waves = 64;              // waves that such a launch takes a slice through
  std::size_t work_group = 64;                 // local size of stages that are not fused
  Traversal traversal = Traversal::automatic;  // not fused, all but binary walk the wide tree ray by ray
  Precision precision = Precision::float32;    // float64: binary alone
  std::optional<cl_uint> fill = {};  // for tests: what streams and film hold before they are written
  // For tests: bytes of the film that are read back at once; 0: all where it lies in the host's memory.
  std::size_t film_piece = 0;

  // All rays are one slice's where they have a work-item each.
  std::uint32_t slices() const { return fused ? n_slices : 1; }

  // Bytes of a queue's slices and their streams, in a frame that the schedule was applied to.
  std::size_t stream_bytes(const layout::Frame& frame, layout::Features features) const;

  // Writes tiles, batch, pool and light batch into the frame.
  void apply(layout::Frame& frame, layout::Features features) const;

  // Fewer slices, and smaller batches where even one slice is too much, so that no buffer of a Wavefront for
  // this frame (but the film) takes more than `max_bytes`: a device's limit for one allocation.
  void fit(layout::Frame frame, layout::Features features, std::size_t max_bytes);
};

// How far a queue is with its list, by its last report.
struct Progress {
  std::uint32_t listed = 0;  // tiles in the list
  std::uint32_t taken = 0;   // of them those whose eye rays have all been traced
  // How far into the list the slice that is furthest has come, less a tile for each other slice.
  std::uint32_t front = 0;
  std::uint64_t waves = 0;  // that this took
  bool at_work = false;     // a slice has rays or tiles left
};

// A launch (all stages of a wave, or many waves fused) that has ended: when on the device's clock, what it
// did.
struct LaunchDone {
  double start = 0, end = 0;  // seconds
  std::uint64_t waves = 0, tiles = 0, rays = 0;
};

// Who is to hear of launches; each may be empty.
struct Watch {
  std::function<void()> before;  // may throw, as a launch may
  std::function<void(const LaunchDone&)> after;
};

// What a queue is to do next: entries to add to its list, none, or std::nullopt to leave everything at once.
using Feed = std::function<std::optional<std::span<const layout::u32>>(const Progress&)>;

// Sums of the film's places from `first` on, three for each: of the picture's pixels, or of samples.
struct FilmSums {
  std::span<const layout::i64> sums;
  std::size_t first;
};

// Places of the film from the picture's pixel, or the sample, `first` on.
struct FilmPiece {
  std::size_t first, n;
};

// How much a queue can hold: entries in a list, the film's pixels, samples of a round of adaptive sampling
// (whole runs).
struct Capacity {
  std::size_t tiles = 0, pixels = 0, samples = 0;
};

class Wavefront {
 public:
  // `frame` has the schedule applied; its film band is set by begin().
  Wavefront(const device::Context& context, cl::CommandQueue queue, const SceneBuffers& scene,
            Programs& programs, const layout::Frame& frame, const Schedule& schedule,
            layout::Features features, const Capacity& capacity);

  ~Wavefront();

  void watch(Watch watch) { watch_ = std::move(watch); }

  // An empty list. The film begins with this pixel of the picture.
  void begin(std::size_t first_pixel);

  // An empty list, of runs of these samples (frame.layout.h), whose places the film has. They stay where they
  // are until render() has returned.
  void begin_samples(std::span<const layout::u32> samples);

  // Renders what `feed` gives, which is asked before each launch, until there is nothing left to do. False:
  // was told to leave.
  bool render(const Feed& feed);

  // How many places of the film should be in a piece that is handed over.
  std::size_t film_piece() const;
  // Hands over the pieces one after the other, each with its number; what was rendered since begin() counts
  // from then on.
  void finish(std::span<const FilmPiece> pieces,
              const std::function<void(std::size_t, const FilmSums&)>& take_film);
  // Where nothing was rendered: the launches that found nothing count.
  void finish();

  // Cycles charged to each tile of the list, when it has been rendered; empty, or all 0, where the device
  // doesn't count them.
  std::vector<layout::u64> tile_cycles();

  // What was counted over the lists that are finished.
  const Counters& counters() const { return counters_; }
  double busy_seconds() const { return busy_seconds_; }  // of all launches that have ended
  std::size_t device_bytes() const { return buffers_.bytes + tile_cycle_bytes(); }
  // Device seconds per stage. Of fused waves they are shares of the launches' time, by the cycles that each
  // stage took; empty where the device has no counter for them.
  const std::map<std::string, double>& stage_seconds() const { return seconds_; }

 private:
  // A launch, and what it left in the slices on its way to the host.
  struct Launch {
    std::span<layout::Slice> slices;
    cl::Event first, last, arrived;
    std::uint32_t listed = 0;
  };

  std::size_t tile_cycle_bytes() const { return schedule_.fused ? capacity_.tiles * sizeof(layout::u64) : 0; }
  template <class K>
  void set_arguments(Stage<K>& stage, const SceneBuffers& scene);
  template <class K>
  cl::Event launch_per_ray(Stage<K>& stage, std::size_t n_rays);
  template <class Do>
  void for_each_stage(const Do& act);
  void make_wave(Programs& programs, const SceneBuffers& scene);
  void make_stages(Programs& programs, const SceneBuffers& scene);
  template <class Do>
  auto or_settle(const Do& act);
  void set_up(Programs& programs, const SceneBuffers& scene);
  void place_slices();
  void film_is_made();
  void warm_up();
  void begin_list();
  bool enlist(const Feed& feed, const Progress& progress);
  void launch(Launch& launch);
  void launch_wave(Launch& launch);
  void launch_stages(Launch& launch);
  cl::Event launch_lights();
  bool go_on(Launch& next, const Feed& feed, const Progress& progress);
  bool render_list(const Feed& feed);
  Progress wait_for(Launch& launch);
  void settle() noexcept;
  std::uint32_t tiles_taken(const Launch& launch) const;
  std::uint32_t front(const Launch& launch) const;
  void tell_of(const Launch& launch, const Counters& sum, std::uint32_t tiles);
  void share_out_seconds();
  void collect();

  const device::Context& context_;
  cl::CommandQueue queue_;
  layout::Frame frame_;
  Schedule schedule_;
  layout::Features features_;
  Capacity capacity_;
  Watch watch_;
  std::optional<device::Pinned> slices_in_host_;  // of both launches, and fresh ones
  std::span<layout::Slice> fresh_;
  Launch launches_[2];
  SliceBuffers buffers_;
  cl::Buffer tile_cycles_;  // of fused waves
  // Either the wave or the others are there.
  std::optional<Stage<kernels::Wave>> wave_;
  std::optional<Stage<kernels::Plan>> plan_;
  std::optional<Stage<kernels::Admit>> admit_;
  std::optional<Stage<kernels::TraceClosest>> trace_closest_;
  std::optional<Stage<kernels::Shade>> shade_;
  std::optional<Stage<kernels::TraceShadow>> trace_shadow_;
  std::optional<Stage<kernels::Add>> add_;
  // Of the present list, as of the last report (n_listed_: as of the last launch).
  std::uint32_t n_listed_ = 0, n_taken_ = 0;
  Counters list_counters_;
  Counters counters_;
  double busy_seconds_ = 0;
  std::map<std::string, double> cycles_;  // of the stages of fused waves
  std::map<std::string, double> seconds_;
};

}  // namespace kdray::wavefront
