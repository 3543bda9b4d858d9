// What    Traces the tiles of a frame on one queue, wave by wave: admit, trace closest, shade, trace shadow, add.
// Shape   n_slices slices, each with a pool, a batch and shadow rays of its own (kernels/raygen/admit.cl has the bound on
//         the pool). Slice s works through the tiles first + s, first + s + n_slices, ...; a wave serves all slices.
// Errors  Counters are read after every wave: a full stack or pool, or a NaN, ends the render with ErrorCode::internal,
//         since the picture would be wrong.
#pragma once

#include <functional>
#include <map>
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
  std::uint32_t batch_size = 256;  // rays a slice traces in one wave
  std::uint32_t n_slices = 256;    // slices in flight on a queue
  std::uint32_t light_batch = 8;   // lights between two waves of shadow rays
  std::size_t work_group = 64;     // local size of the per-ray stages

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

  // Renders the tiles [first, end) and returns the sums of the `n_pixels` pixels from `first_pixel` on.
  // `tiles_done` hears how many tiles have been finished since it was last called.
  std::vector<layout::i64> render_tiles(std::uint32_t first, std::uint32_t end, std::size_t first_pixel,
                                        std::size_t n_pixels,
                                        const std::function<void(std::uint32_t)>& tiles_done);

  const Counters& counters() const { return counters_; }
  std::size_t device_bytes() const { return device_bytes_; }
  // Device seconds per stage.
  const std::map<std::string, double>& stage_seconds() const { return seconds_; }

 private:
  cl::Buffer make(std::size_t bytes, const std::string& what);
  void set_arguments(const SceneBuffers& scene);
  void launch_wave();
  void launch_lights();
  void check() const;
  bool read_slices();
  void collect();

  const device::Context& context_;
  cl::CommandQueue queue_;
  layout::Frame frame_;
  Schedule schedule_;
  std::uint32_t features_;
  std::vector<layout::Slice> slices_;
  std::size_t device_bytes_ = 0;
  cl::Buffer frame_buffer_, slice_buffer_, pool_, batch_, hits_, shadow_rays_, occluded_, film_;
  Stage admit_, trace_closest_, shade_, trace_shadow_, add_;
  Counters counters_;
  std::map<std::string, double> seconds_;
};

}  // namespace kdray::wavefront
