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

bool at_work(const layout::Slice& slice, std::uint32_t n_listed) {
  return slice.tile < n_listed || slice.n_batch > 0 ||
         std::any_of(std::begin(slice.n_pool), std::end(slice.n_pool), [](layout::u32 n) { return n > 0; });
}

// Entries, and behind them two words for each sample; what is read beyond the last is left out.
std::size_t list_words(const Room& room) {
  return room.tiles + (room.samples > 0 ? 2 * room.samples + KDRAY_LANES : 0);
}

double seconds_of(const cl::Event& event, cl_profiling_info moment) {
  cl_ulong nanoseconds = 0;
  event.getProfilingInfo(moment, &nanoseconds);
  return 1e-9 * static_cast<double>(nanoseconds);
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

std::size_t Schedule::stream_bytes(const layout::Frame& frame) const {
  const std::size_t word = precision == Precision::float64 ? sizeof(double) : sizeof(float);
  const std::size_t pooled_depths = frame.pool_size > 0 ? frame.max_depth - 1 : 0;
  const std::size_t words = pooled_depths * KDRAY_POOL_FIELDS * frame.pool_capacity +
                            std::size_t{KDRAY_RAY_FIELDS + KDRAY_HIT_FIELDS} * frame.batch_capacity +
                            std::size_t{KDRAY_SHADOW_FIELDS} * frame.shadow_capacity;
  return n_slices * (sizeof(layout::Slice) + words * word + frame.shadow_capacity);
}

namespace {

std::size_t largest_buffer_of_a_slice(const layout::Frame& frame) {
  const std::size_t pooled_depths = frame.pool_size > 0 ? frame.max_depth - 1 : 0;
  return std::max({sizeof(layout::Slice),
                   pooled_depths * KDRAY_POOL_FIELDS * frame.pool_capacity * sizeof(float),
                   std::size_t{KDRAY_RAY_FIELDS} * frame.batch_capacity * sizeof(float),
                   std::size_t{KDRAY_SHADOW_FIELDS} * frame.shadow_capacity * sizeof(float)});
}

}  // namespace

void Schedule::fit(layout::Frame frame, std::uint32_t features, std::size_t max_bytes) {
  for (;; batch_size /= 2) {
    apply(frame, features);
    const std::size_t of_slice = largest_buffer_of_a_slice(frame);
    n_slices = static_cast<std::uint32_t>(std::clamp<std::size_t>(max_bytes / of_slice, 1, n_slices));
    if (of_slice <= max_bytes || batch_size == 1) return;
  }
}

void Counters::add(const layout::Slice& s) {
  primary += s.n_primary;
  primary_hit += s.n_primary_hit;
  shadow += s.n_shadow_rays;
  reflected += s.n_reflected;
  refracted += s.n_refracted;
  skipped_behind += s.n_skipped_behind;
  skipped_unlit += s.n_skipped_unlit;
  skipped_open += s.n_skipped_open;
  skipped_background += s.n_skipped_background;
  skipped_weight += s.n_skipped_weight;
  skipped_depth += s.n_skipped_depth;
  invalid += s.n_invalid;
  nan += s.n_nan;
  pool_overflow += s.n_pool_overflow;
  waves += s.n_waves;
}

void Counters::add(const Counters& o) {
  primary += o.primary;
  primary_hit += o.primary_hit;
  shadow += o.shadow;
  reflected += o.reflected;
  refracted += o.refracted;
  skipped_behind += o.skipped_behind;
  skipped_unlit += o.skipped_unlit;
  skipped_open += o.skipped_open;
  skipped_background += o.skipped_background;
  skipped_weight += o.skipped_weight;
  skipped_depth += o.skipped_depth;
  invalid += o.invalid;
  nan += o.nan;
  pool_overflow += o.pool_overflow;
  waves += o.waves;
  launches += o.launches;
}

cl::Buffer Wavefront::make(std::size_t bytes, const std::string& what) {
  device_bytes_ += bytes;
  return context_.buffer(CL_MEM_READ_WRITE, bytes, what);
}

cl::Buffer Wavefront::make_stream(std::size_t n_fields, std::size_t capacity, const std::string& what) {
  const std::size_t word = schedule_.precision == Precision::float64 ? sizeof(double) : sizeof(float);
  return make(schedule_.n_slices * n_fields * capacity * word, what);
}

Wavefront::Wavefront(const device::Context& context, cl::CommandQueue queue, const SceneBuffers& scene,
                     Programs& programs, const layout::Frame& frame, const Schedule& schedule,
                     std::uint32_t features, const Room& room)
    : context_(context),
      queue_(std::move(queue)),
      frame_(frame),
      schedule_(schedule),
      features_(features),
      room_{std::max(room.tiles, room.samples / KDRAY_SAMPLE_RUN), std::max(room.pixels, room.samples),
            room.samples},
      frame_buffer_(make(sizeof(layout::Frame), "the frame")),
      slice_buffer_(make(schedule.n_slices * sizeof(layout::Slice), "the slices")),
      list_(make(list_words(room_) * sizeof(layout::u32), "the list of tiles")),
      tile_cycles_(make(schedule.fused ? room_.tiles * sizeof(layout::u64) : 0, "the tiles' cycles")),
      pool_(make_stream(frame.pool_size > 0 ? (frame.max_depth - 1) * KDRAY_POOL_FIELDS : 0,
                        frame.pool_capacity, "the ray pools")),
      batch_(make_stream(KDRAY_RAY_FIELDS, frame.batch_capacity, "the ray batches")),
      hits_(make_stream(KDRAY_HIT_FIELDS, frame.batch_capacity, "the hits")),
      shadow_rays_(make_stream(KDRAY_SHADOW_FIELDS, frame.shadow_capacity, "the shadow rays")),
      occluded_(make(std::size_t{schedule.n_slices} * frame.shadow_capacity, "the occlusion flags")),
      film_(context.buffer_made_beside(CL_MEM_READ_WRITE, room_.pixels * 3 * sizeof(layout::i64), "the film",
                                       false, film_made_)) {
  device_bytes_ += room_.pixels * 3 * sizeof(layout::i64);
  device::checked("setting up the kernels", [&] {
    if (schedule.fill) fill_streams(*schedule.fill);
    schedule.fused ? make_wave(programs, scene) : make_stages(programs, scene);
    warm_up();
    if (film_made_.valid()) film_made_.get();
  });
}

void Wavefront::fill_streams(cl_uint word) {
  for (const cl::Buffer* buffer : {&pool_, &batch_, &hits_, &shadow_rays_, &occluded_, &film_})
    queue_.enqueueFillBuffer(*buffer, word, 0, buffer->getInfo<CL_MEM_SIZE>() / sizeof word * sizeof word);
}

// Calls `act` with every stage that is there.
template <class Do>
void Wavefront::for_each_stage(const Do& act) {
  const auto act_on = [&](auto&... stages) { ((stages ? act(*stages) : void()), ...); };
  act_on(wave_, admit_, trace_closest_, shade_, trace_shadow_, add_);
}

// PoCL compiles a kernel for good at its first launch: here one that finds nothing to do, not in the frame's
// time.
void Wavefront::warm_up() {
  const device::AtWork compiling(context_.builds());
  begin(0);
  launch(launches_[0]);
  queue_.finish();
  for_each_stage([](auto& stage) { stage.forget_launches(); });
}

// What doesn't change from launch to launch.
template <class K>
void Wavefront::set_arguments(Stage<K>& stage, const SceneBuffers& scene) {
  scene.set_arguments(stage);
  KDRAY_SET_WHERE_TAKEN(K, stage, frame, frame_buffer_);
  KDRAY_SET_WHERE_TAKEN(K, stage, n_slices, schedule_.n_slices);
  KDRAY_SET_WHERE_TAKEN(K, stage, n_waves, schedule_.fused_waves);
  KDRAY_SET_WHERE_TAKEN(K, stage, slices, slice_buffer_);
  KDRAY_SET_WHERE_TAKEN(K, stage, tiles, list_);
  KDRAY_SET_WHERE_TAKEN(K, stage, tile_cycles, tile_cycles_);
  KDRAY_SET_WHERE_TAKEN(K, stage, pool, pool_);
  KDRAY_SET_WHERE_TAKEN(K, stage, batch, batch_);
  KDRAY_SET_WHERE_TAKEN(K, stage, hits, hits_);
  KDRAY_SET_WHERE_TAKEN(K, stage, shadow_rays, shadow_rays_);
  KDRAY_SET_WHERE_TAKEN(K, stage, occluded, occluded_);
  KDRAY_SET_WHERE_TAKEN(K, stage, film, film_);
}

void Wavefront::make_wave(Programs& programs, const SceneBuffers& scene) {
  wave_.emplace(programs.kernel<kernels::Wave>(features_, schedule_.traversal, schedule_.precision));
  set_arguments(*wave_, scene);
}

void Wavefront::make_stages(Programs& programs, const SceneBuffers& scene) {
  using namespace kernels;
  const Traversal none = Traversal::binary;
  const Traversal walk = schedule_.traversal == Traversal::binary ? Traversal::binary : Traversal::wide;
  const bool lights = (features_ & KDRAY_FEATURE_LIGHTS) != 0;
  std::vector<Programs::Wanted> wanted = {{Admit::kFile, features_, none, schedule_.precision},
                                          {TraceClosest::kFile, features_, walk, schedule_.precision},
                                          {Shade::kFile, features_, none, schedule_.precision}};
  if (lights) wanted.push_back({TraceShadow::kFile, features_, walk, schedule_.precision});
  if (lights) wanted.push_back({Add::kFile, features_, none, schedule_.precision});
  programs.build(wanted);
  const auto make = [&]<class K>(std::optional<Stage<K>>& stage, Traversal traversal) {
    stage.emplace(programs.kernel<K>(features_, traversal, schedule_.precision));
    set_arguments(*stage, scene);
  };
  make(admit_, none);
  make(trace_closest_, walk);
  make(shade_, none);
  // Without lights these two are neither built nor launched.
  if (!lights) return;
  make(trace_shadow_, walk);
  make(add_, none);
}

Wavefront::~Wavefront() {
  settle();
}

// After an error a report, or tiles, may still be on their way.
void Wavefront::settle() noexcept {
  try {
    queue_.finish();
  } catch (const cl::Error&) {  // nothing left to wait for
  }
}

template <class K>
cl::Event Wavefront::launch_per_slice(Stage<K>& stage) {
  return stage.launch(queue_, schedule_.n_slices, 1);
}

template <class K>
cl::Event Wavefront::launch_per_ray(Stage<K>& stage, std::size_t rays_of_slice) {
  return stage.launch(queue_, schedule_.n_slices * rays_of_slice, schedule_.work_group);
}

// The event of the last.
cl::Event Wavefront::launch_lights() {
  cl_uint first = 0;
  cl::Event last;
  do {
    shade_->set(kernels::Shade::first_light, first);
    last = launch_per_slice(*shade_);
    if (frame_.light_batch > 0) {
      launch_per_ray(*trace_shadow_, std::size_t{frame_.batch_size} * frame_.light_batch);
      last = launch_per_slice(*add_);
    }
    first += frame_.light_batch;
  } while (frame_.light_batch > 0 && first < frame_.n_lights);
  return last;
}

void Wavefront::launch_stages(Launch& launch) {
  admit_->set(kernels::Admit::n_tiles, n_listed_);
  launch.first = launch_per_slice(*admit_);
  launch_per_ray(*trace_closest_, frame_.batch_size);
  launch.last = launch_lights();
}

void Wavefront::launch_wave(Launch& launch) {
  wave_->set(kernels::Wave::n_tiles, n_listed_);
  launch.first = launch.last = launch_per_slice(*wave_);
}

void Wavefront::launch(Launch& launch) {
  launch.listed = n_listed_;
  wave_ ? launch_wave(launch) : launch_stages(launch);
  queue_.enqueueReadBuffer(slice_buffer_, CL_FALSE, 0, launch.slices.size() * sizeof(layout::Slice),
                           launch.slices.data(), nullptr, &launch.arrived);
  queue_.flush();
}

void Wavefront::begin(std::size_t first_pixel) {
  frame_.first_pixel = static_cast<layout::u32>(first_pixel);
  frame_.samples_at = 0;
  begin_list();
}

void Wavefront::begin_samples(std::span<const layout::u32> samples) {
  frame_.first_pixel = 0;
  frame_.samples_at = static_cast<layout::u32>(room_.tiles);
  device::checked("writing the samples", [&] {
    queue_.enqueueWriteBuffer(list_, CL_FALSE, room_.tiles * sizeof(layout::u32), samples.size_bytes(),
                              samples.data());
  });
  begin_list();
}

void Wavefront::begin_list() {
  n_listed_ = n_taken_ = 0;
  list_counters_ = {};
  std::vector<layout::Slice> slices(schedule_.n_slices);
  for (std::uint32_t s = 0; s < schedule_.n_slices; ++s) {
    slices[s].tile = s;
    slices[s].tile_stride = schedule_.n_slices;
  }
  for (Launch& launch : launches_) launch.slices.resize(schedule_.n_slices);
  device::checked("beginning a list of tiles", [&] {
    if (wave_) queue_.enqueueFillBuffer(tile_cycles_, layout::u64{0}, 0, room_.tiles * sizeof(layout::u64));
    queue_.enqueueWriteBuffer(frame_buffer_, CL_TRUE, 0, sizeof frame_, &frame_);
    queue_.enqueueWriteBuffer(slice_buffer_, CL_TRUE, 0, slices.size() * sizeof(layout::Slice),
                              slices.data());
  });
}

// Puts what there is to do at the end of the list. The device may still be at work before it. False: leave.
bool Wavefront::enlist(const Feed& feed, const Progress& progress) {
  const auto more = feed(progress);
  if (!more) return false;
  if (more->empty()) return true;
  const std::size_t first = n_listed_;
  queue_.enqueueWriteBuffer(list_, CL_FALSE, first * sizeof(layout::u32), more->size_bytes(), more->data());
  n_listed_ += static_cast<std::uint32_t>(more->size());
  return true;
}

std::uint32_t Wavefront::tiles_taken(const Launch& launch) const {
  std::uint32_t taken = 0;
  for (std::uint32_t s = 0; s < schedule_.n_slices; ++s)
    taken += (launch.slices[s].tile - s) / schedule_.n_slices;
  return taken;
}

std::uint32_t Wavefront::front(const Launch& launch) const {
  std::uint32_t furthest = 0;
  for (const layout::Slice& slice : launch.slices) furthest = std::max(furthest, slice.tile);
  return std::min(furthest + 1 - schedule_.n_slices, launch.listed);  // slice s begins with entry s
}

void Wavefront::tell_of(const Launch& launch, const Counters& sum, std::uint32_t tiles) {
  const double start = seconds_of(launch.first, CL_PROFILING_COMMAND_START);
  const double end = seconds_of(launch.last, CL_PROFILING_COMMAND_END);
  busy_seconds_ += end - start;
  if (watch_.after)
    watch_.after({start, end, sum.waves - list_counters_.waves, tiles, sum.total() - list_counters_.total()});
}

Progress Wavefront::wait_for(Launch& launch) {
  launch.arrived.wait();
  collect();
  Counters sum;
  for (const layout::Slice& slice : launch.slices) sum.add(slice);
  check(sum);
  sum.launches = list_counters_.launches + 1;
  const std::uint32_t taken = tiles_taken(launch);
  tell_of(launch, sum, taken - n_taken_);
  n_taken_ = taken;
  list_counters_ = sum;
  const auto busy = [&](const layout::Slice& slice) { return at_work(slice, launch.listed); };
  return {launch.listed, taken, front(launch), sum.waves,
          std::any_of(launch.slices.begin(), launch.slices.end(), busy)};
}

bool Wavefront::go_on(Launch& next, const Feed& feed, const Progress& progress) {
  if (!enlist(feed, progress)) return false;
  if (watch_.before) watch_.before();
  launch(next);
  return true;
}

bool Wavefront::render_list(const Feed& feed) {
  Progress progress;
  if (!go_on(launches_[0], feed, progress)) return false;
  for (std::size_t n = 0;; ++n) {
    if (!go_on(launches_[(n + 1) % 2], feed, progress)) return false;
    progress = wait_for(launches_[n % 2]);
    if (progress.at_work || progress.listed < n_listed_) continue;
    // The launch in flight finds nothing to do; the frame may still have something.
    if (!enlist(feed, progress)) return false;
    if (progress.listed == n_listed_) return true;
  }
}

bool Wavefront::render(const Feed& feed) {
  try {
    const bool ended = device::checked("rendering", [&] { return render_list(feed); });
    if (!ended) settle();
    return ended;
  } catch (...) {
    settle();
    throw;
  }
}

void Wavefront::finish(std::size_t first, std::size_t n,
                       const std::function<void(const FilmSums&)>& take_film) {
  device::checked("reading the film", [&] {
    constexpr std::size_t kPlace = 3 * sizeof(layout::i64);
    void* const sums = queue_.enqueueMapBuffer(film_, CL_TRUE, CL_MAP_READ,
                                               (first - frame_.first_pixel) * kPlace, n * kPlace);
    take_film({{static_cast<const layout::i64*>(sums), n * 3}, first});
    queue_.enqueueUnmapMemObject(film_, sums);
  });
  finish();
}

void Wavefront::finish() {
  collect();
  if (wave_) share_out_seconds();
  counters_.add(list_counters_);
}

std::vector<layout::u64> Wavefront::tile_cycles() {
  std::vector<layout::u64> cycles(wave_ ? n_listed_ : 0);
  if (!cycles.empty())
    device::checked("reading the tiles' cycles", [&] {
      queue_.enqueueReadBuffer(tile_cycles_, CL_TRUE, 0, cycles.size() * sizeof(layout::u64), cycles.data());
    });
  return cycles;
}

// With every launch, so that a long frame doesn't keep an event per launch.
void Wavefront::collect() {
  for_each_stage([&](auto& stage) { seconds_[stage.name()] = stage.collect_seconds(); });
}

// Divides the waves' time among their stages. Both reports are as good: the last launch found nothing to do.
void Wavefront::share_out_seconds() {
  for (const layout::Slice& s : launches_[0].slices) {
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
