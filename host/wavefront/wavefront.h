// What    Traces the tiles of a frame on one queue, wave by wave: admit, trace closest, shade, trace shadow, add; in one
//         launch for all stages (CPUs) or in one for each.
// Shape   n_slices slices, each with a pool, a batch and shadow rays of its own (kernels/raygen/admit.clh has the bound on
//         the pool). Slice s works through the tiles first + s, first + s + n_slices, ...; a wave serves all slices.
//         The next wave is queued before the host looks at what the last one left: the device never waits for the host,
//         and runs one empty wave at the end.
// Errors  Counters are read after every wave: a full stack or pool, or a NaN, ends the render with ErrorCode::internal,
//         since the picture would be wrong.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "layout/frame.layout.h"
#include "wavefront/programs.h"
#include "wavefront/scene_buffers.h"
#include "wavefront/stage.h"

namespace kdray::wavefront {

// How a frame is cut up for the device. A choice changes time and memory, never the picture.
struct Schedule {
  std::uint32_t tile_width = 32, tile_height = 32;
  std::uint32_t batch_size = 512;  // rays a slice traces in one wave
  std::uint32_t n_slices = 64;     // slices in flight on a queue
  std::uint32_t light_batch = 8;   // lights between two waves of shadow rays, KDRAY_MAX_LIGHT_BATCH at most
  bool fused = true;               // all stages in one launch (for CPUs); false: one launch per stage
  std::uint32_t fused_waves = 64;  // waves that such a launch takes a slice through
  std::size_t work_group = 64;     // local size of the stages that have one ray per work-item
  Traversal traversal = Traversal::automatic;  // not fused, all but binary walk the wide tree ray by ray

  // Writes tiles, batch, pool and light batch into the frame.
  void apply(layout::Frame& frame, std::uint32_t features) const;
};

struct Counters {
  std::uint64_t primary = 0, primary_hit = 0, shadow = 0, reflected = 0, refracted = 0;
  std::uint64_t skipped_behind = 0, skipped_unlit = 0, skipped_weight = 0, skipped_depth = 0;
  std::uint64_t invalid = 0, nan = 0, pool_overflow = 0;
  std::uint64_t waves = 0;

  std::uint64_t total() const { return primary + shadow + reflected + refracted; }
  void add(const layout::Slice& slice);
  void add(const Counters& other);
};

class Wavefront {
 public:
  // `frame` has the schedule applied; its film band is set per call of render_tiles.
  Wavefront(const device::Context& context, cl::CommandQueue queue, const SceneBuffers& scene,
            Programs& programs, const layout::Frame& frame, const Schedule& schedule, std::uint32_t features,
            std::size_t band_pixels);

  ~Wavefront();

  // Renders the tiles [first, end) and hands the sums of the `n_pixels` pixels from `first_pixel` on to `take_film`.
  // `tiles_done` hears how many tiles have been finished since it was last called.
  void render_tiles(std::uint32_t first, std::uint32_t end, std::size_t first_pixel, std::size_t n_pixels,
                    const std::function<void(std::uint32_t)>& tiles_done,
                    const std::function<void(std::span<const layout::i64>)>& take_film);

  const Counters& counters() const { return counters_; }
  std::size_t device_bytes() const { return device_bytes_; }
  // Device seconds per stage. Of fused waves they are shares of the launches' time, by the cycles that each stage took;
  // empty where the device has no counter for them.
  const std::map<std::string, double>& stage_seconds() const { return seconds_; }

 private:
  // What a wave left in the slices, on its way to the host.
  struct Report {
    std::vector<layout::Slice> slices;
    cl::Event arrived;
  };

  cl::Buffer make(std::size_t bytes, const std::string& what);
  cl::Buffer make_stream(std::size_t n_fields, std::size_t capacity, const std::string& what);
  void launch_per_slice(Stage& stage);
  void launch_per_ray(Stage& stage, std::size_t rays_of_slice);
  void make_wave(Programs& programs, const SceneBuffers& scene);
  void make_stages(Programs& programs, const SceneBuffers& scene);
  void warm_up();
  void begin(std::uint32_t first, std::uint32_t end, std::size_t first_pixel);
  void launch_wave(Report& report);
  void launch_stages();
  void launch_lights();
  void share_out_seconds(const Report& last);
  bool wait_for(Report& report);
  void hand_over_film(std::size_t n_pixels,
                      const std::function<void(std::span<const layout::i64>)>& take_film);
  void collect();

  const device::Context& context_;
  cl::CommandQueue queue_;
  layout::Frame frame_;
  Schedule schedule_;
  std::uint32_t features_;
  Report reports_[2];
  std::size_t device_bytes_ = 0;
  cl::Buffer frame_buffer_, slice_buffer_, pool_, batch_, hits_, shadow_rays_, occluded_, film_;
  // Either the wave or the others are there.
  std::optional<Stage> wave_, admit_, trace_closest_, shade_, trace_shadow_, add_;
  Counters counters_;
  std::map<std::string, double> cycles_;  // of the stages of fused waves
  std::map<std::string, double> seconds_;
};

}  // namespace kdray::wavefront
