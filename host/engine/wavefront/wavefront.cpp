#include "engine/wavefront/wavefront.h"

#include <algorithm>
#include <limits>

#include "device/opencl/clock.h"
#include "device/opencl/opencl_error.h"
#include "device/opencl/read_back.h"
#include "layout/features.h"
#include "layout/rays.layout.h"

namespace kdray::wavefront {

namespace {

bool at_work(const layout::Slice& slice, std::uint32_t n_listed) {
  return slice.tile < n_listed || slice.n_batch > 0 ||
         std::any_of(std::begin(slice.n_pool), std::end(slice.n_pool), [](layout::u32 n) { return n > 0; });
}

constexpr std::size_t kPlaceBytes = 3 * sizeof(layout::i64);

// In which each stage's reals are computed.
std::size_t word_of(Precision precision) {
  return precision == Precision::float64 ? sizeof(double) : sizeof(float);
}

}  // namespace

void Schedule::apply(layout::Frame& frame, layout::Features features) const {
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
  // A program that has lights all the same is to find none.
  if (!(features & KDRAY_FEATURE_LIGHTS)) frame.n_lights = 0;
  frame.light_batch = std::min({light_batch, frame.n_lights, std::uint32_t{KDRAY_MAX_LIGHT_BATCH}});
  frame.shadow_capacity = frame.light_batch * frame.batch_capacity;
  frame.tells_sample = (features & KDRAY_FEATURE_AREA_LIGHTS) != 0 ? 1 : 0;
}

std::size_t Schedule::stream_bytes(const layout::Frame& frame, layout::Features features) const {
  return slices() * StreamForm::of_device(frame, word_of(precision), features).bytes(frame);
}

void Schedule::fit(layout::Frame frame, layout::Features features, std::size_t max_bytes) {
  for (;; batch_size /= 2) {
    apply(frame, features);
    const std::size_t of_slice = StreamForm::of_device(frame, sizeof(float), features).largest(frame);
    n_slices = static_cast<std::uint32_t>(std::clamp<std::size_t>(max_bytes / of_slice, 1, n_slices));
    if (of_slice <= max_bytes || batch_size == 1) return;
  }
}

// Returns what `act` does. When it fails, what is under way is waited for first: it uses memory that is about
// to go, and buffers that the next frame may be given.
template <class Do>
auto Wavefront::or_settle(const Do& act) {
  try {
    return act();
  } catch (...) {
    settle();
    throw;
  }
}

Wavefront::Wavefront(const device::Context& context, cl::CommandQueue queue, const SceneBuffers& scene,
                     Programs& programs, const layout::Frame& frame, const Schedule& schedule,
                     layout::Features features, const Capacity& capacity)
    : context_(context),
      queue_(std::move(queue)),
      frame_(frame),
      schedule_(schedule),
      features_(features),
      capacity_{std::max(capacity.tiles, capacity.samples / KDRAY_SAMPLE_RUN),
                std::max(capacity.pixels, capacity.samples), capacity.samples},
      buffers_(context, frame, {schedule.slices(), capacity_.tiles, capacity_.samples, capacity_.pixels},
               StreamForm::of_device(frame, word_of(schedule.precision), features)),
      tile_cycles_(context.buffer(CL_MEM_READ_WRITE, tile_cycle_bytes(), "the tiles' cycles")) {
  device::checked("setting up the kernels", [&] { or_settle([&] { set_up(programs, scene); }); });
}

void Wavefront::set_up(Programs& programs, const SceneBuffers& scene) {
  place_slices();
  if (schedule_.fill) buffers_.fill(queue_, *schedule_.fill);
  schedule_.fused ? make_wave(programs, scene) : make_stages(programs, scene);
  if (!schedule_.fused) film_is_made();  // which is cleared
  const Programs::Launches launches{features_,
                                    schedule_.traversal,
                                    schedule_.precision,
                                    schedule_.fused,
                                    schedule_.fused ? schedule_.slices() : frame_.batch_size,
                                    schedule_.fused ? 1 : schedule_.work_group};
  if (programs.are_new(launches)) {
    warm_up();
    programs.were_launched(launches);
  }
  film_is_made();
}

void Wavefront::place_slices() {
  const std::size_t n = schedule_.slices();
  slices_in_host_.emplace(context_, queue_, 3 * n * sizeof(layout::Slice));
  const std::span all(static_cast<layout::Slice*>(slices_in_host_->memory()), 3 * n);
  for (std::size_t i = 0; i < 2; ++i) launches_[i].slices = all.subspan(i * n, n);
  fresh_ = all.subspan(2 * n, n);
  std::ranges::copy(fresh_slices(schedule_.slices()), fresh_.begin());
}

void Wavefront::film_is_made() {
  if (buffers_.film_made.valid()) buffers_.film_made.get();
}

// Calls `act` with every stage that is there.
template <class Do>
void Wavefront::for_each_stage(const Do& act) {
  const auto act_on = [&](auto&... stages) { ((stages ? act(*stages) : void()), ...); };
  act_on(wave_, plan_, admit_, trace_closest_, shade_, trace_shadow_, add_);
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
  buffers_.set_arguments(stage);
  KDRAY_SET_WHERE_TAKEN(K, stage, n_slices, schedule_.slices());
  KDRAY_SET_WHERE_TAKEN(K, stage, n_waves, schedule_.fused_waves);
  KDRAY_SET_WHERE_TAKEN(K, stage, tile_cycles, tile_cycles_);
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
  std::vector<Programs::Wanted> wanted = {{Plan::kFile, features_, none, schedule_.precision},
                                          {Admit::kFile, features_, none, schedule_.precision},
                                          {TraceClosest::kFile, features_, walk, schedule_.precision},
                                          {Shade::kFile, features_, none, schedule_.precision}};
  if (lights) wanted.push_back({TraceShadow::kFile, features_, walk, schedule_.precision});
  if (lights) wanted.push_back({Add::kFile, features_, none, schedule_.precision});
  programs.build(wanted);
  const auto make = [&]<class K>(std::optional<Stage<K>>& stage, Traversal traversal) {
    stage.emplace(programs.kernel<K>(features_, traversal, schedule_.precision));
    set_arguments(*stage, scene);
    if constexpr (requires { K::wide_nodes; })
      if (traversal == Traversal::wide) stage->set(K::wide_nodes, scene.compressed_nodes());
  };
  make(plan_, none);
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
cl::Event Wavefront::launch_per_ray(Stage<K>& stage, std::size_t n_rays) {
  return stage.launch(queue_, n_rays, schedule_.work_group);
}

// The event of the last.
cl::Event Wavefront::launch_lights() {
  cl_uint first = 0;
  cl::Event last;
  do {
    shade_->set(kernels::Shade::first_light, first);
    last = launch_per_ray(*shade_, frame_.batch_size);
    if (frame_.light_batch > 0) {
      const std::size_t n_shadow_rays = std::size_t{frame_.batch_size} * frame_.light_batch;
      launch_per_ray(*trace_shadow_, n_shadow_rays);
      last = launch_per_ray(*add_, n_shadow_rays);
    }
    first += frame_.light_batch;
  } while (frame_.light_batch > 0 && first < frame_.n_lights);
  return last;
}

void Wavefront::launch_stages(Launch& launch) {
  plan_->set(kernels::Plan::n_tiles, n_listed_);
  launch.first = plan_->launch(queue_, 1, 1);
  launch_per_ray(*admit_, frame_.batch_size);
  launch_per_ray(*trace_closest_, frame_.batch_size);
  launch.last = launch_lights();
}

void Wavefront::launch_wave(Launch& launch) {
  wave_->set(kernels::Wave::n_tiles, n_listed_);
  launch.first = launch.last = wave_->launch(queue_, schedule_.slices(), 1);
}

void Wavefront::launch(Launch& launch) {
  launch.listed = n_listed_;
  wave_ ? launch_wave(launch) : launch_stages(launch);
  queue_.enqueueReadBuffer(buffers_.slices, CL_FALSE, 0, launch.slices.size_bytes(), launch.slices.data(),
                           nullptr, &launch.arrived);
  queue_.flush();
}

void Wavefront::begin(std::size_t first_pixel) {
  frame_.first_pixel = static_cast<layout::u32>(first_pixel);
  frame_.samples_at = 0;
  or_settle([&] { begin_list(); });
}

void Wavefront::begin_samples(std::span<const layout::u32> samples) {
  frame_.first_pixel = 0;
  frame_.samples_at = static_cast<layout::u32>(capacity_.tiles);
  or_settle([&] {
    device::checked("writing the samples", [&] {
      queue_.enqueueWriteBuffer(buffers_.tiles, CL_FALSE, capacity_.tiles * sizeof(layout::u32),
                                samples.size_bytes(), samples.data());
    });
    begin_list();
  });
}

void Wavefront::begin_list() {
  n_listed_ = n_taken_ = 0;
  list_counters_ = {};
  device::checked("beginning a list of tiles", [&] {
    if (wave_)
      queue_.enqueueFillBuffer(tile_cycles_, layout::u64{0}, 0, capacity_.tiles * sizeof(layout::u64));
    else
      queue_.enqueueFillBuffer(buffers_.film, layout::i64{0}, 0, buffers_.film.getInfo<CL_MEM_SIZE>());
    queue_.enqueueWriteBuffer(buffers_.frame, CL_FALSE, 0, sizeof frame_, &frame_);
    queue_.enqueueWriteBuffer(buffers_.slices, CL_FALSE, 0, fresh_.size_bytes(), fresh_.data());
  });
}

// Puts what there is to do at the end of the list. The device may still be at work before it. False: leave.
bool Wavefront::enlist(const Feed& feed, const Progress& progress) {
  const auto more = feed(progress);
  if (!more) return false;
  if (more->empty()) return true;
  const std::size_t first = n_listed_;
  queue_.enqueueWriteBuffer(buffers_.tiles, CL_FALSE, first * sizeof(layout::u32), more->size_bytes(),
                            more->data());
  n_listed_ += static_cast<std::uint32_t>(more->size());
  return true;
}

std::uint32_t Wavefront::tiles_taken(const Launch& launch) const {
  std::uint32_t taken = 0;
  const std::uint32_t n_slices = schedule_.slices();
  for (std::uint32_t s = 0; s < n_slices; ++s) taken += (launch.slices[s].tile - s) / n_slices;
  return taken;
}

std::uint32_t Wavefront::front(const Launch& launch) const {
  std::uint32_t furthest = 0;
  for (const layout::Slice& slice : launch.slices) furthest = std::max(furthest, slice.tile);
  return std::min(furthest + 1 - schedule_.slices(), launch.listed);  // slice s begins with entry s
}

void Wavefront::tell_of(const Launch& launch, const Counters& sum, std::uint32_t tiles) {
  const auto start = device::profiled_nanoseconds(launch.first, CL_PROFILING_COMMAND_START);
  const auto end = device::profiled_nanoseconds(launch.last, CL_PROFILING_COMMAND_END);
  busy_seconds_ += 1e-9 * static_cast<double>(end - start);
  if (watch_.after)
    watch_.after({1e-9 * static_cast<double>(start), 1e-9 * static_cast<double>(end),
                  sum.waves - list_counters_.waves, tiles, sum.total() - list_counters_.total()});
}

Progress Wavefront::wait_for(Launch& launch) {
  launch.arrived.wait();
  collect();
  Counters sum = sum_of(launch.slices);
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
  return or_settle([&] {
    const bool ended = device::checked("rendering", [&] { return render_list(feed); });
    if (!ended) settle();
    return ended;
  });
}

std::size_t Wavefront::film_piece() const {
  if (schedule_.film_piece == 0 && context_.works_in_host_memory())
    return std::numeric_limits<std::size_t>::max();
  return (schedule_.film_piece > 0 ? schedule_.film_piece : device::kPieceBytes) / kPlaceBytes;
}

void Wavefront::finish(std::span<const FilmPiece> pieces,
                       const std::function<void(std::size_t, const FilmSums&)>& take_film) {
  const auto take = [&](std::size_t i, const void* sums) {
    take_film(i, {{static_cast<const layout::i64*>(sums), pieces[i].n * 3}, pieces[i].first});
  };
  std::vector<device::Piece> bytes;
  for (const FilmPiece& piece : pieces)
    bytes.push_back({(piece.first - frame_.first_pixel) * kPlaceBytes, piece.n * kPlaceBytes});
  device::checked("reading the film", [&] {
    if (film_piece() < std::numeric_limits<std::size_t>::max())
      return device::read_pieces(context_, queue_, buffers_.film, bytes, take);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      void* const sums =
          queue_.enqueueMapBuffer(buffers_.film, CL_TRUE, CL_MAP_READ, bytes[i].first, bytes[i].n);
      const auto unmap = [&] { queue_.enqueueUnmapMemObject(buffers_.film, sums); };
      try {
        take(i, sums);
      } catch (...) {
        unmap();
        throw;
      }
      unmap();
    }
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
  add_cycles(launches_[0].slices, cycles_);
  double sum = 0;
  for (const auto& [stage, cycles] : cycles_) sum += cycles;
  if (sum == 0) return;
  for (const auto& [stage, cycles] : cycles_) seconds_[stage] = seconds_["wave"] * (cycles / sum);
}

}  // namespace kdray::wavefront
