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

// A stream's words per field for `n` rays: whole vectors, and one behind the last ray (rays.layout.h).
std::uint32_t capacity_for(std::uint32_t n) {
  return (n + 2 * KDRAY_LANES - 1) / KDRAY_LANES * KDRAY_LANES;
}

bool busy(const layout::Slice& slice) {
  return slice.tile < slice.end_tile || slice.n_batch > 0 ||
         std::any_of(std::begin(slice.n_pool), std::end(slice.n_pool), [](layout::u32 n) { return n > 0; });
}

void check(const Counters& sum) {
  if (sum.invalid + sum.nan + sum.pool_overflow == 0) return;
  throw Error(
      ErrorCode::internal,
      fmt::format("{} rays overflowed the traversal's stack, {} the ray pool, and {} contributions were not "
                  "numbers; this is a fault of kdray, please report it with the scene",
                  sum.invalid, sum.pool_overflow, sum.nan));
}

}  // namespace

void Schedule::apply(layout::Frame& frame, std::uint32_t features) const {
  frame.tile_width = tile_width;
  frame.tile_height = tile_height;
  frame.n_tiles_x = (frame.width + tile_width - 1) / tile_width;
  frame.n_tiles = frame.n_tiles_x * ((frame.height + tile_height - 1) / tile_height);
  frame.batch_size = batch_size;
  frame.batch_capacity = capacity_for(batch_size);
  // admit.clh: less than a batch waits at a depth when a batch adds to it what it spawns.
  const std::uint32_t spawned = spawned_per_ray(features);
  frame.pool_size = spawned == 0 ? 0 : (1 + spawned) * batch_size;
  frame.pool_capacity = capacity_for(frame.pool_size);
  frame.light_batch = features & KDRAY_FEATURE_LIGHTS
                          ? std::min({light_batch, frame.n_lights, std::uint32_t{KDRAY_MAX_LIGHT_BATCH}})
                          : 0;
  frame.shadow_capacity = frame.light_batch * frame.batch_capacity;
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

cl::Buffer Wavefront::make_stream(std::size_t n_fields, std::size_t capacity, const std::string& what) {
  return make(schedule_.n_slices * n_fields * capacity * sizeof(float), what);
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
      pool_(make_stream(frame.pool_size > 0 ? (frame.max_depth - 1) * KDRAY_POOL_FIELDS : 0,
                        frame.pool_capacity, "the ray pools")),
      batch_(make_stream(KDRAY_RAY_FIELDS, frame.batch_capacity, "the ray batches")),
      hits_(make_stream(KDRAY_HIT_FIELDS, frame.batch_capacity, "the hits")),
      shadow_rays_(make_stream(KDRAY_SHADOW_FIELDS, frame.shadow_capacity, "the shadow rays")),
      occluded_(make(std::size_t{schedule.n_slices} * frame.shadow_capacity, "the occlusion flags")),
      film_(make(band_pixels * 3 * sizeof(layout::i64), "the film")) {
  device::checked("setting up the kernels", [&] {
    schedule.fused ? make_wave(programs, scene) : make_stages(programs, scene);
    warm_up();
  });
}

// PoCL compiles a kernel for good at its first launch: here one that finds nothing to do, not in the frame's time.
void Wavefront::warm_up() {
  begin(0, 0, 0);
  launch_wave(reports_[0]);
  queue_.finish();
  for (std::optional<Stage>* stage : {&wave_, &admit_, &trace_closest_, &shade_, &trace_shadow_, &add_})
    if (*stage) (*stage)->forget_launches();
}

void Wavefront::make_wave(Programs& programs, const SceneBuffers& scene) {
  wave_.emplace("wave", programs.kernel("wave/wave.cl", "wave", features_, schedule_.traversal));
  wave_->set_arguments(scene.set_tree_arguments(wave_->kernel()), scene.normals, scene.materials,
                       scene.lights, frame_buffer_, cl_uint{schedule_.n_slices},
                       cl_uint{schedule_.fused_waves}, slice_buffer_, pool_, batch_, hits_, shadow_rays_,
                       occluded_, film_);
}

void Wavefront::make_stages(Programs& programs, const SceneBuffers& scene) {
  const cl_uint n = schedule_.n_slices;
  const Traversal walk = schedule_.traversal == Traversal::binary ? Traversal::binary : Traversal::wide;
  admit_.emplace("admit", programs.kernel("raygen/admit.cl", "admit", features_));
  admit_->set_arguments(0, frame_buffer_, n, slice_buffer_, pool_, batch_, film_);
  trace_closest_.emplace("trace_closest",
                         programs.kernel("traverse/trace_closest.cl", "trace_closest", features_, walk));
  trace_closest_->set_arguments(scene.set_tree_arguments(trace_closest_->kernel()), frame_buffer_, n,
                                slice_buffer_, batch_, hits_);
  shade_.emplace("shade", programs.kernel("shade/shade.cl", "shade", features_));
  shade_->set_arguments(0, scene.triangles, scene.normals, scene.spheres, scene.cones, scene.materials,
                        scene.lights, frame_buffer_, n, cl_uint{0}, slice_buffer_, batch_, hits_, pool_,
                        shadow_rays_, film_);
  // Without lights these two are neither built nor launched.
  if (!(features_ & KDRAY_FEATURE_LIGHTS)) return;
  trace_shadow_.emplace("trace_shadow",
                        programs.kernel("traverse/trace_shadow.cl", "trace_shadow", features_, walk));
  trace_shadow_->set_arguments(scene.set_tree_arguments(trace_shadow_->kernel()), frame_buffer_, n,
                               slice_buffer_, shadow_rays_, occluded_);
  add_.emplace("add", programs.kernel("film/add.cl", "add", features_));
  add_->set_arguments(0, frame_buffer_, n, slice_buffer_, shadow_rays_, occluded_, film_);
}

// A report may still be on its way after an error.
Wavefront::~Wavefront() {
  try {
    queue_.finish();
  } catch (const cl::Error&) {  // nothing left to wait for
  }
}

void Wavefront::launch_per_slice(Stage& stage) {
  stage.launch(queue_, schedule_.n_slices, 1);
}

void Wavefront::launch_per_ray(Stage& stage, std::size_t rays_of_slice) {
  stage.launch(queue_, schedule_.n_slices * rays_of_slice, schedule_.work_group);
}

void Wavefront::launch_lights() {
  constexpr cl_uint kFirstLight = 8;  // shade's argument
  cl_uint first = 0;
  do {
    shade_->set_arguments(kFirstLight, first);
    launch_per_slice(*shade_);
    if (frame_.light_batch > 0) {
      launch_per_ray(*trace_shadow_, std::size_t{frame_.batch_size} * frame_.light_batch);
      launch_per_slice(*add_);
    }
    first += frame_.light_batch;
  } while (frame_.light_batch > 0 && first < frame_.n_lights);
}

void Wavefront::launch_stages() {
  launch_per_slice(*admit_);
  launch_per_ray(*trace_closest_, frame_.batch_size);
  launch_lights();
}

void Wavefront::launch_wave(Report& report) {
  wave_ ? launch_per_slice(*wave_) : launch_stages();
  queue_.enqueueReadBuffer(slice_buffer_, CL_FALSE, 0, report.slices.size() * sizeof(layout::Slice),
                           report.slices.data(), nullptr, &report.arrived);
  queue_.flush();
}

// True as long as a slice has work.
bool Wavefront::wait_for(Report& report) {
  report.arrived.wait();
  ++counters_.waves;
  collect();
  Counters sum;
  for (const layout::Slice& slice : report.slices) sum.add(slice);
  check(sum);
  return std::any_of(report.slices.begin(), report.slices.end(), busy);
}

void Wavefront::begin(std::uint32_t first, std::uint32_t end, std::size_t first_pixel) {
  frame_.first_pixel = static_cast<layout::u32>(first_pixel);
  std::vector<layout::Slice> slices(schedule_.n_slices);
  for (std::uint32_t s = 0; s < schedule_.n_slices; ++s) {
    slices[s].tile = first + s;
    slices[s].end_tile = end;
    slices[s].tile_stride = schedule_.n_slices;
  }
  for (Report& report : reports_) report.slices.resize(schedule_.n_slices);
  queue_.enqueueWriteBuffer(frame_buffer_, CL_TRUE, 0, sizeof frame_, &frame_);
  queue_.enqueueWriteBuffer(slice_buffer_, CL_TRUE, 0, slices.size() * sizeof(layout::Slice), slices.data());
}

void Wavefront::hand_over_film(std::size_t n_pixels,
                               const std::function<void(std::span<const layout::i64>)>& take_film) {
  const std::size_t n_sums = n_pixels * 3;
  void* sums = queue_.enqueueMapBuffer(film_, CL_TRUE, CL_MAP_READ, 0, n_sums * sizeof(layout::i64));
  take_film({static_cast<const layout::i64*>(sums), n_sums});
  queue_.enqueueUnmapMemObject(film_, sums);
}

void Wavefront::render_tiles(std::uint32_t first, std::uint32_t end, std::size_t first_pixel,
                             std::size_t n_pixels, const std::function<void(std::uint32_t)>& tiles_done,
                             const std::function<void(std::span<const layout::i64>)>& take_film) {
  device::checked("rendering", [&] {
    begin(first, end, first_pixel);
    std::uint32_t done = 0;
    std::size_t wave = 0;
    bool working = true;
    for (launch_wave(reports_[0]); working; ++wave) {
      launch_wave(reports_[(wave + 1) % 2]);
      const Report& report = reports_[wave % 2];
      working = wait_for(reports_[wave % 2]);
      std::uint32_t now = 0;
      for (std::uint32_t s = 0; s < schedule_.n_slices; ++s)
        now += (report.slices[s].tile - (first + s)) / schedule_.n_slices;
      if (now > done) tiles_done(now - done);
      done = now;
    }
    hand_over_film(n_pixels, take_film);  // waits for the last wave, which was empty
    const Report& last = reports_[wave % 2];
    for (const layout::Slice& slice : last.slices) counters_.add(slice);
    collect();
    if (wave_) share_out_seconds(last);
  });
}

// With every wave, so that a long frame doesn't keep an event per launch.
void Wavefront::collect() {
  for (std::optional<Stage>* stage : {&wave_, &admit_, &trace_closest_, &shade_, &trace_shadow_, &add_})
    if (*stage) seconds_[(*stage)->name()] = (*stage)->collect_seconds();
}

// Divides the waves' time among their stages. The report is the band's last, with the cycles of all its waves.
void Wavefront::share_out_seconds(const Report& report) {
  for (const layout::Slice& s : report.slices) {
    cycles_["admit"] += static_cast<double>(s.cycles_admit);
    cycles_["trace_closest"] += static_cast<double>(s.cycles_closest);
    cycles_["shade"] += static_cast<double>(s.cycles_shade);
    cycles_["trace_shadow"] += static_cast<double>(s.cycles_shadow);
    cycles_["add"] += static_cast<double>(s.cycles_add);
  }
  double sum = 0;
  for (const auto& [stage, cycles] : cycles_) sum += cycles;
  if (sum == 0) return;
  for (const auto& [stage, cycles] : cycles_) seconds_[stage] = seconds_["wave"] * (cycles / sum);
}

}  // namespace kdray::wavefront
