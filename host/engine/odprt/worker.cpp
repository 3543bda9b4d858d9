#include "engine/odprt/worker.h"

#include <algorithm>
#include <numeric>

#include "device/opencl/read_back.h"
#include "layout/features.h"
#include "layout/rays.layout.h"

namespace kdray::odprt {

cl::Buffer Worker::make(std::size_t bytes, const char* what) {
  bytes_ += bytes;
  return context_.buffer(CL_MEM_READ_WRITE, bytes, what);
}

Worker::Worker(const device::Context& context, cl::CommandQueue queue, wavefront::Programs& programs,
               const layout::Frame& frame, const BufferPlan& plan, layout::Features features,
               Traversal traversal, std::size_t work_group, std::span<const layout::PartCell> directory,
               const WorkCapacity& capacity, std::size_t max_subtrees)
    : context_(context),
      queue_(std::move(queue)),
      frame_(frame),
      plan_(plan),
      capacity_(capacity),
      slices_(plan.n_slices),
      traffic_(plan.n_slices),
      visits_(2 * plan.n_slices * max_subtrees),
      buffers_(context, frame, {plan.n_slices, capacity.entries, capacity.samples, capacity.places},
               wavefront::StreamForm::of_odprt(frame, features)),
      travel_buffer_(make(sizeof(layout::Travel), "the division")),
      cells_(make(directory.size_bytes(), "the directory")),
      credit_buffer_(make(plan.n_slices * sizeof(layout::Credits), "the slices' credits")),
      traffic_buffer_(make(plan.n_slices * sizeof(layout::Traffic), "the slices' accounts")),
      shadow_pool_(make(std::size_t{plan.n_slices} * KDRAY_TRAVEL_SHADOW_FIELDS *
                            (plan.shadow_pool + 2 * KDRAY_LANES) * sizeof(float),
                        "the waiting shadow rays")),
      visit_buffer_(make(visits_.size() * sizeof(layout::u32), "the subtrees' visits")),
      inbox_(context, plan.inbox) {
  if (plan.per_ray) {
    stages_.emplace(programs, features | KDRAY_FEATURE_NUMBERS, work_group);
  } else {
    wave_.emplace(programs.kernel<kernels::TravelWave>(features | KDRAY_FEATURE_NUMBERS, traversal));
    receive_.emplace(programs.kernel<kernels::Receive>(features));
  }
  bytes_ += inbox_.bytes() + buffers_.bytes;
  if (!directory.empty())
    queue_.enqueueWriteBuffer(cells_, CL_TRUE, 0, directory.size_bytes(), directory.data());
  travel_.n_places = plan.outbox.n_places;
  travel_.n_cells = static_cast<layout::u32>(directory.size());
  travel_.n_slices = plan.n_slices;
  travel_.out_rays = plan.outbox.rays;
  travel_.out_ray_capacity = plan.outbox.ray_capacity;
  travel_.out_shadow = plan.outbox.shadow;
  travel_.out_shadow_capacity = plan.outbox.shadow_capacity;
  travel_.shadow_pool = plan.shadow_pool;
  travel_.shadow_pool_capacity = plan.shadow_pool + 2 * KDRAY_LANES;
  for_each_stage([this](auto& stage) { set_arguments(stage); });
}

template <class Do>
void Worker::for_each_stage(const Do& act) {
  if (stages_) return stages_->for_each(act);
  act(*wave_), act(*receive_);
}

// What doesn't change from launch to launch.
template <class K>
void Worker::set_arguments(wavefront::Stage<K>& stage) {
  buffers_.set_arguments(stage);
  KDRAY_SET_WHERE_TAKEN(K, stage, travel, travel_buffer_);
  KDRAY_SET_WHERE_TAKEN(K, stage, n_waves, plan_.n_waves);
  KDRAY_SET_WHERE_TAKEN(K, stage, cells, cells_);
  KDRAY_SET_WHERE_TAKEN(K, stage, credits, credit_buffer_);
  KDRAY_SET_WHERE_TAKEN(K, stage, traffic, traffic_buffer_);
  KDRAY_SET_WHERE_TAKEN(K, stage, shadow_pool, shadow_pool_);
  KDRAY_SET_WHERE_TAKEN(K, stage, visits, visit_buffer_);
}

// A command may still be running after an error.
Worker::~Worker() {
  try {
    queue_.finish();
  } catch (const cl::Error&) {  // nothing left to wait for
  }
}

void Worker::begin(const Work& work) {
  frame_.first_pixel = static_cast<layout::u32>(work.first_pixel);
  frame_.samples_at = work.samples.empty() ? 0 : static_cast<layout::u32>(capacity_.entries);
  n_places_ = work.n_places;
  in_runs_ = !work.samples.empty();
  list_.clear();
  list_.reserve(capacity_.entries);  // what is added stays where it is while it is being copied
  const std::vector<layout::Slice> fresh = wavefront::fresh_slices(plan_.n_slices);
  std::copy(fresh.begin(), fresh.end(), slices_.begin());
  std::fill(traffic_.begin(), traffic_.end(), layout::Traffic{});
  queue_.enqueueWriteBuffer(buffers_.frame, CL_FALSE, 0, sizeof frame_, &frame_);
  if (!work.samples.empty())
    queue_.enqueueWriteBuffer(buffers_.tiles, CL_FALSE, capacity_.entries * sizeof(layout::u32),
                              work.samples.size_bytes(), work.samples.data());
  queue_.enqueueWriteBuffer(buffers_.slices, CL_FALSE, 0, slices_.size() * sizeof(layout::Slice),
                            slices_.data());
  queue_.enqueueWriteBuffer(traffic_buffer_, CL_FALSE, 0, traffic_.size() * sizeof(layout::Traffic),
                            traffic_.data());
  if (n_places_ > 0 && buffers_.film_made.valid())
    buffers_.film_made.get();  // 0 already
  else if (n_places_ > 0)
    queue_.enqueueFillBuffer(buffers_.film, cl_long{0}, 0, n_places_ * 3 * sizeof(layout::i64));
  if (!visits_.empty())
    queue_.enqueueFillBuffer(visit_buffer_, cl_uint{0}, 0, visits_.size() * sizeof(layout::u32));
  queue_.finish();
}

void Worker::add(std::span<const layout::u32> entries) {
  if (entries.empty()) return;
  const std::size_t first = list_.size();
  list_.insert(list_.end(), entries.begin(), entries.end());
  queue_.enqueueWriteBuffer(buffers_.tiles, CL_FALSE, first * sizeof(layout::u32), entries.size_bytes(),
                            &list_[first]);
}

std::uint32_t Worker::launch_tiles() const {
  constexpr std::uint32_t kEyeWaves = 4;  // one wave of so many is of eye rays
  const std::uint32_t n_rays = plan_.n_slices * plan_.n_waves * frame_.batch_size / kEyeWaves;
  return n_rays / (in_runs_ ? KDRAY_SAMPLE_RUN : frame_.tile_width * frame_.tile_height * frame_.n_samples);
}

void Worker::serve(const LoadedPart& part, std::uint32_t census_every) {
  travel_.part = part.number;
  travel_.n_shared = part.n_shared;
  travel_.replicated = part.replicates ? 1 : 0;
  travel_.n_subtrees = census_every > 0 ? part.n_subtrees : 0;
  travel_.census_every = std::max(census_every, 1u);
  queue_.enqueueWriteBuffer(travel_buffer_, CL_FALSE, 0, sizeof travel_, &travel_);
  for_each_stage([&]<class K>(wavefront::Stage<K>& stage) {
    part.scene.set_arguments(stage);
    KDRAY_SET_WHERE_TAKEN(K, stage, subtrees, part.subtrees);
    if constexpr (requires { K::wide_nodes; })
      if (stages_) stage.set(K::wide_nodes, part.scene.compressed_nodes());
  });
}

void Worker::warm_up(const LoadedPart& part, Outbox& outbox) {
  const device::AtWork compiling(context_.builds());
  begin({});
  serve(part, 0);
  std::fill(outbox.n().begin(), outbox.n().end(), 0);
  queue_.enqueueFillBuffer(outbox.counts(), cl_uint{0}, 0, outbox.n().size() * sizeof(layout::u32));
  receive(outbox, std::min(part.number, outbox.shape().n_places - 1));
  const std::vector<layout::Credits> credits(plan_.n_slices);
  launch(credits, outbox);
  for_each_stage([](auto& stage) { stage.forget_launches(); });
}

void Worker::receive(const Outbox& outbox, std::uint32_t place) {
  if (stages_) return stages_->receive(queue_, outbox, place);
  using K = kernels::Receive;
  outbox.set_arguments(*receive_);
  receive_->set(K::place, place).set(K::n_places, outbox.shape().n_places);
  receive_->set(K::ray_capacity, outbox.shape().ray_capacity);
  receive_->set(K::shadow_capacity, outbox.shape().shadow_capacity);
  receive_->launch(queue_, plan_.n_slices, 1);
}

std::uint64_t Worker::receive(HostRayQueue& host_rays) {
  const OutboxShape& shape = inbox_.shape();
  auto* rays = static_cast<float*>(queue_.enqueueMapBuffer(
      inbox_.rays(), CL_FALSE, CL_MAP_WRITE_INVALIDATE_REGION, 0,  // the next one waits for both
      shape.n_streams() * shape.ray_fields * shape.ray_capacity * sizeof(float)));
  auto* shadow_rays = static_cast<float*>(queue_.enqueueMapBuffer(
      inbox_.shadow_rays(), CL_TRUE, CL_MAP_WRITE_INVALIDATE_REGION, 0,
      shape.n_streams() * KDRAY_SENT_SHADOW_FIELDS * shape.shadow_capacity * sizeof(float)));
  std::uint64_t total = 0;
  for (std::uint32_t s = 0; s < plan_.n_slices; ++s) {
    const auto fullest =
        *std::max_element(std::begin(slices_[s].n_pool), std::begin(slices_[s].n_pool) + frame_.max_depth);
    const std::size_t n =
        std::min<std::size_t>({host_rays.rays[s].size(), shape.rays, frame_.pool_size - fullest});
    const std::size_t n_shadow = std::min<std::size_t>(
        {host_rays.shadow_rays[s].size(), shape.shadow, plan_.shadow_pool - traffic_[s].n_shadow_pool});
    host_rays.rays[s].take(rays + std::size_t{s} * shape.ray_fields * shape.ray_capacity, shape.ray_capacity,
                           0, n);
    host_rays.shadow_rays[s].take(
        shadow_rays + std::size_t{s} * KDRAY_SENT_SHADOW_FIELDS * shape.shadow_capacity,
        shape.shadow_capacity, 0, n_shadow);
    inbox_.n()[s] = static_cast<layout::u32>(n);
    inbox_.n()[plan_.n_slices + s] = static_cast<layout::u32>(n_shadow);
    total += n + n_shadow;
  }
  queue_.enqueueUnmapMemObject(inbox_.rays(), rays);
  queue_.enqueueUnmapMemObject(inbox_.shadow_rays(), shadow_rays);
  host_rays.n -= total;
  if (total == 0) return 0;
  queue_.enqueueWriteBuffer(inbox_.counts(), CL_FALSE, 0, inbox_.n().size() * sizeof(layout::u32),
                            inbox_.n().data());
  receive(inbox_, 0);
  return total;
}

void Worker::launch_waves(const Outbox& outbox) {
  const auto n_tiles = static_cast<cl_uint>(list_.size());
  if (stages_) return stages_->launch(queue_, frame_, plan_.n_waves, n_tiles, outbox);
  wave_->set(kernels::TravelWave::n_tiles, n_tiles);
  outbox.set_arguments(*wave_);
  wave_->launch(queue_, plan_.n_slices, 1);
}

void Worker::launch(std::span<const layout::Credits> credits, Outbox& outbox) {
  queue_.enqueueWriteBuffer(credit_buffer_, CL_FALSE, 0, credits.size_bytes(), credits.data());
  queue_.enqueueFillBuffer(outbox.counts(), cl_uint{0}, 0, outbox.n().size() * sizeof(layout::u32));
  launch_waves(outbox);
  queue_.enqueueReadBuffer(outbox.counts(), CL_FALSE, 0, outbox.n().size() * sizeof(layout::u32),
                           outbox.n().data());
  finish();
}

void Worker::finish() {
  queue_.enqueueReadBuffer(buffers_.slices, CL_FALSE, 0, slices_.size() * sizeof(layout::Slice),
                           slices_.data());
  queue_.enqueueReadBuffer(traffic_buffer_, CL_TRUE, 0, traffic_.size() * sizeof(layout::Traffic),
                           traffic_.data());
  for_each_stage([](auto& stage) { stage.collect_seconds(); });
}

void Worker::stash(HostRayQueue& host_rays) {
  const std::size_t pool_words = std::size_t{plan_.inbox.ray_fields} * frame_.pool_capacity;
  const std::size_t shadow_words = KDRAY_TRAVEL_SHADOW_FIELDS * std::size_t{travel_.shadow_pool_capacity};
  stashed_.clear();
  const auto begin_reading = [&](const cl::Buffer& buffer, std::size_t place, std::size_t n_words) {
    std::vector<float>& words = stashed_.emplace_back(n_words);
    queue_.enqueueReadBuffer(buffer, CL_FALSE, place * n_words * sizeof(float), n_words * sizeof(float),
                             words.data());
  };
  const auto for_each_in_use = [&](const auto& rays, const auto& shadow_rays) {
    for (std::uint32_t s = 0; s < plan_.n_slices; ++s) {
      for (std::uint32_t depth = 1; depth <= frame_.max_depth; ++depth)
        if (slices_[s].n_pool[depth - 1] > 0) rays(s, depth, slices_[s].n_pool[depth - 1]);
      if (traffic_[s].n_shadow_pool > 0) shadow_rays(s, traffic_[s].n_shadow_pool);
    }
  };
  for_each_in_use(
      [&](std::uint32_t s, std::uint32_t depth, layout::u32) {
        begin_reading(buffers_.pool, std::size_t{s} * frame_.max_depth + (depth - 1), pool_words);
      },
      [&](std::uint32_t s, layout::u32) { begin_reading(shadow_pool_, s, shadow_words); });
  queue_.finish();
  auto words = stashed_.begin();
  for_each_in_use(
      [&](std::uint32_t s, std::uint32_t depth, layout::u32& n) {
        host_rays.put_pooled_rays(s, (words++)->data(), frame_.pool_capacity, n, depth);
        n = 0;
      },
      [&](std::uint32_t s, layout::u32& n) {
        for (layout::u32 i = 0; i < n; ++i)
          host_rays.put_shadow_ray(s, words->data(), travel_.shadow_pool_capacity, i);
        ++words;
        n = 0;
      });
  stashed_.clear();
  queue_.enqueueWriteBuffer(buffers_.slices, CL_FALSE, 0, slices_.size() * sizeof(layout::Slice),
                            slices_.data());
  queue_.enqueueWriteBuffer(traffic_buffer_, CL_FALSE, 0, traffic_.size() * sizeof(layout::Traffic),
                            traffic_.data());
}

void Worker::copy_out(const Outbox& outbox, const std::function<HostRayQueue*(std::uint32_t)>& host_rays_of) {
  const OutboxShape& shape = outbox.shape();
  const std::size_t ray_words = std::size_t{shape.ray_fields} * shape.ray_capacity;
  const std::size_t shadow_words = std::size_t{KDRAY_SENT_SHADOW_FIELDS} * shape.shadow_capacity;
  const auto map = [&](const cl::Buffer& buffer, std::size_t words) {
    return static_cast<float*>(
        queue_.enqueueMapBuffer(buffer, CL_TRUE, CL_MAP_READ, 0, shape.n_streams() * words * sizeof(float)));
  };
  float* const rays = map(outbox.rays(), ray_words);
  float* const shadow_rays = map(outbox.shadow_rays(), shadow_words);
  for (std::size_t i = 0; i < shape.n_streams(); ++i) {
    const std::size_t place = i / shape.n_slices, slice = i % shape.n_slices;
    if (shape.n_places > 1 && host_rays_of(static_cast<std::uint32_t>(place)) == nullptr) continue;
    sort_rays(rays + i * ray_words, shape.ray_capacity, outbox.n()[i], slice, host_rays_of);
    sort_shadow_rays(shadow_rays + i * shadow_words, shape.shadow_capacity, outbox.n()[shape.n_streams() + i],
                     slice, host_rays_of);
  }
  queue_.enqueueUnmapMemObject(outbox.rays(), rays);
  queue_.enqueueUnmapMemObject(outbox.shadow_rays(), shadow_rays);
}

void Worker::add_stages(std::map<std::string, double>& times) {
  if (stages_) {
    for (const auto& [stage, seconds] : stages_->seconds()) times[stage] += seconds;
    return;
  }
  wavefront::add_cycles(slices_, times);
  for (const layout::Traffic& traffic : traffic_) times["route"] += static_cast<double>(traffic.cycles_route);
}

double Worker::busy_seconds() {
  double sum = 0;
  for_each_stage([&](auto& stage) { sum += stage.collect_seconds(); });
  return sum;
}

std::uint32_t Worker::tiles_left() const {
  std::uint32_t n = 0;
  const auto n_tiles = static_cast<std::uint32_t>(list_.size());
  for (const layout::Slice& slice : slices_)
    if (slice.tile < n_tiles) n += (n_tiles - slice.tile + slice.tile_stride - 1) / slice.tile_stride;
  return n;
}

std::uint64_t Worker::n_waiting() const {
  std::uint64_t n = 0;
  for (std::size_t s = 0; s < slices_.size(); ++s)
    n = std::accumulate(std::begin(slices_[s].n_pool), std::end(slices_[s].n_pool),
                        n + traffic_[s].n_shadow_pool);
  return n;
}

std::vector<SubtreeUse> Worker::visits() const {
  const std::size_t n = travel_.n_subtrees;
  std::vector<SubtreeUse> sums(n);
  std::vector<layout::u32> counts(2 * n * plan_.n_slices);
  if (n == 0) return sums;
  queue_.enqueueReadBuffer(visit_buffer_, CL_TRUE, 0, counts.size() * sizeof(layout::u32), counts.data());
  for (std::size_t i = 0; i < counts.size(); ++i)
    (i / n % 2 == 0 ? sums[i % n].visits : sums[i % n].hits) += counts[i];
  return sums;
}

void Worker::with_film(const std::function<void(std::span<const layout::i64>)>& take) {
  const std::size_t n = n_places_ * 3, bytes = n * sizeof(layout::i64);
  const auto take_from = [&](const void* sums) { take({static_cast<const layout::i64*>(sums), n}); };
  if (!context_.works_in_host_memory()) {
    const device::Piece whole{0, bytes};
    return device::read_pieces(context_, queue_, buffers_.film, {&whole, 1},
                               [&](std::size_t, const void* sums) { take_from(sums); });
  }
  void* const sums = queue_.enqueueMapBuffer(buffers_.film, CL_TRUE, CL_MAP_READ, 0, bytes);
  take_from(sums);
  queue_.enqueueUnmapMemObject(buffers_.film, sums);
}

}  // namespace kdray::odprt
