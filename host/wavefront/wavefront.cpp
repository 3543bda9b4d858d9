#include "wavefront/wavefront.h"

#include <fmt/format.h>

#include <algorithm>

#include "device/opencl_error.h"
#include "layout/features.h"
#include "layout/rays.layout.h"

namespace kdray::wavefront {

namespace {

// Rays that one ray can put into the pool. Where one is refracted another may be reflected, if of no weight.
std::uint32_t spawned_per_ray(std::uint32_t features) {
  if (features & KDRAY_FEATURE_TRANSMIT) return 2;
  return features & KDRAY_FEATURE_REFLECT ? 1 : 0;
}

bool busy(const layout::Slice& slice) {
  return slice.tile < slice.end_tile || slice.n_pool > 0;
}

}  // namespace

void Schedule::apply(layout::Frame& frame, std::uint32_t features) const {
  frame.tile_width = tile_width;
  frame.tile_height = tile_height;
  frame.n_tiles_x = (frame.width + tile_width - 1) / tile_width;
  frame.n_tiles = frame.n_tiles_x * ((frame.height + tile_height - 1) / tile_height);
  frame.batch_size = batch_size;
  // admit.cl: at most one batch per depth when a ray spawns two, one batch in all when it spawns one.
  const std::uint32_t spawned = spawned_per_ray(features);
  frame.pool_size = spawned == 0 ? 0 : (spawned == 1 ? batch_size : batch_size * frame.max_depth);
  frame.light_batch = features & KDRAY_FEATURE_LIGHTS ? std::min(light_batch, frame.n_lights) : 0;
}

void Counters::add(const layout::Slice& s) {
  primary += s.n_primary;
  primary_hit += s.n_primary_hit;
  shadow += s.n_shadow_rays;
  reflected += s.n_reflected;
  refracted += s.n_refracted;
  skipped_behind += s.n_skipped_behind;
  skipped_unlit += s.n_skipped_unlit;
  skipped_weight += s.n_skipped_weight;
  skipped_depth += s.n_skipped_depth;
  invalid += s.n_invalid;
  nan += s.n_nan;
  pool_overflow += s.n_pool_overflow;
}

void Counters::add(const Counters& o) {
  primary += o.primary;
  primary_hit += o.primary_hit;
  shadow += o.shadow;
  reflected += o.reflected;
  refracted += o.refracted;
  skipped_behind += o.skipped_behind;
  skipped_unlit += o.skipped_unlit;
  skipped_weight += o.skipped_weight;
  skipped_depth += o.skipped_depth;
  invalid += o.invalid;
  nan += o.nan;
  pool_overflow += o.pool_overflow;
  waves += o.waves;
}

cl::Buffer Wavefront::make(std::size_t bytes, const std::string& what) {
  device_bytes_ += bytes;
  return context_.buffer(CL_MEM_READ_WRITE, bytes, what);
}

Wavefront::Wavefront(const device::Context& context, cl::CommandQueue queue, const SceneBuffers& scene,
                     Programs& programs, const layout::Frame& frame, const Schedule& schedule,
                     std::uint32_t features, std::size_t band_pixels)
    : context_(context),
      queue_(std::move(queue)),
      frame_(frame),
      schedule_(schedule),
      features_(features),
      frame_buffer_(make(sizeof(layout::Frame), "the frame")),
      slice_buffer_(make(schedule.n_slices * sizeof(layout::Slice), "the slices")),
      pool_(make(sizeof(layout::Ray) * schedule.n_slices * frame.pool_size, "the ray pools")),
      batch_(make(sizeof(layout::Ray) * schedule.n_slices * frame.batch_size, "the ray batches")),
      hits_(make(sizeof(layout::Hit) * schedule.n_slices * frame.batch_size, "the hits")),
      shadow_rays_(make(sizeof(layout::ShadowRay) * schedule.n_slices * frame.batch_size * frame.light_batch,
                        "the shadow rays")),
      occluded_(
          make(std::size_t{schedule.n_slices} * frame.batch_size * frame.light_batch, "the occlusion flags")),
      film_(make(band_pixels * 3 * sizeof(layout::i64), "the film")),
      admit_("admit", programs.kernel("raygen/admit.cl", "admit", features)),
      trace_closest_("trace_closest",
                     programs.kernel("traverse/trace_closest.cl", "trace_closest", features)),
      shade_("shade", programs.kernel("shade/shade.cl", "shade", features)),
      // Without lights these two are neither built nor launched.
      trace_shadow_("trace_shadow",
                    features & KDRAY_FEATURE_LIGHTS
                        ? programs.kernel("traverse/trace_shadow.cl", "trace_shadow", features)
                        : cl::Kernel()),
      add_("add",
           features & KDRAY_FEATURE_LIGHTS ? programs.kernel("film/add.cl", "add", features) : cl::Kernel()) {
  device::checked("setting up the kernels", [&] { set_arguments(scene); });
}

void Wavefront::set_arguments(const SceneBuffers& scene) {
  const cl_uint n = schedule_.n_slices;
  admit_.set_arguments(0, frame_buffer_, n, slice_buffer_, pool_, batch_);
  trace_closest_.set_arguments(scene.set_tree_arguments(trace_closest_.kernel()), frame_buffer_, n,
                               slice_buffer_, batch_, hits_);
  shade_.set_arguments(0, scene.triangles, scene.normals, scene.spheres, scene.cones, scene.materials,
                       scene.lights, frame_buffer_, n, cl_uint{0}, slice_buffer_, batch_, hits_, pool_,
                       shadow_rays_, film_);
  if (!(features_ & KDRAY_FEATURE_LIGHTS)) return;
  trace_shadow_.set_arguments(scene.set_tree_arguments(trace_shadow_.kernel()), frame_buffer_, n,
                              slice_buffer_, shadow_rays_, occluded_);
  add_.set_arguments(0, frame_buffer_, n, slice_buffer_, shadow_rays_, occluded_, film_);
}

void Wavefront::launch_lights() {
  constexpr cl_uint kFirstLight = 8;  // shade's argument
  const std::size_t n = schedule_.n_slices;
  cl_uint first = 0;
  do {
    shade_.set_arguments(kFirstLight, first);
    shade_.launch(queue_, n, 1);
    if (frame_.light_batch > 0) {
      trace_shadow_.launch(queue_, n * frame_.batch_size * frame_.light_batch, schedule_.work_group);
      add_.launch(queue_, n, 1);
    }
    first += frame_.light_batch;
  } while (frame_.light_batch > 0 && first < frame_.n_lights);
}

void Wavefront::launch_wave() {
  admit_.launch(queue_, schedule_.n_slices, 1);
  trace_closest_.launch(queue_, std::size_t{schedule_.n_slices} * frame_.batch_size, schedule_.work_group);
  launch_lights();
  ++counters_.waves;
}

// True as long as a slice has work. Waits for the wave.
bool Wavefront::read_slices() {
  queue_.enqueueReadBuffer(slice_buffer_, CL_TRUE, 0, slices_.size() * sizeof(layout::Slice), slices_.data());
  collect();
  check();
  return std::any_of(slices_.begin(), slices_.end(), busy);
}

void Wavefront::check() const {
  Counters sum;
  for (const layout::Slice& slice : slices_) sum.add(slice);
  if (sum.invalid + sum.nan + sum.pool_overflow == 0) return;
  throw Error(
      ErrorCode::internal,
      fmt::format("{} rays overflowed the traversal's stack, {} the ray pool, and {} contributions were not "
                  "numbers; this is a fault of kdray, please report it with the scene",
                  sum.invalid, sum.pool_overflow, sum.nan));
}

std::vector<layout::i64> Wavefront::render_tiles(std::uint32_t first, std::uint32_t end,
                                                 std::size_t first_pixel, std::size_t n_pixels,
                                                 const std::function<void(std::uint32_t)>& tiles_done) {
  return device::checked("rendering", [&] {
    frame_.first_pixel = static_cast<layout::u32>(first_pixel);
    slices_.assign(schedule_.n_slices, layout::Slice{});
    for (std::uint32_t s = 0; s < schedule_.n_slices; ++s) {
      slices_[s].tile = first + s;
      slices_[s].end_tile = end;
      slices_[s].tile_stride = schedule_.n_slices;
    }
    queue_.enqueueWriteBuffer(frame_buffer_, CL_TRUE, 0, sizeof frame_, &frame_);
    queue_.enqueueWriteBuffer(slice_buffer_, CL_TRUE, 0, slices_.size() * sizeof(layout::Slice),
                              slices_.data());
    queue_.enqueueFillBuffer(film_, layout::i64{0}, 0, n_pixels * 3 * sizeof(layout::i64));
    std::uint32_t done = 0;
    bool working = true;
    while (working) {
      launch_wave();
      working = read_slices();
      std::uint32_t now = 0;
      for (std::uint32_t s = 0; s < schedule_.n_slices; ++s)
        now += (slices_[s].tile - (first + s)) / schedule_.n_slices;
      if (now > done) tiles_done(now - done);
      done = now;
    }
    for (const layout::Slice& slice : slices_) counters_.add(slice);
    std::vector<layout::i64> sums(n_pixels * 3);
    queue_.enqueueReadBuffer(film_, CL_TRUE, 0, sums.size() * sizeof(layout::i64), sums.data());
    return sums;
  });
}

// After every wave, so that a long frame doesn't keep an event per launch.
void Wavefront::collect() {
  for (Stage* stage : {&admit_, &trace_closest_, &shade_, &trace_shadow_, &add_})
    seconds_[stage->name()] = stage->collect_seconds();
}

}  // namespace kdray::wavefront
