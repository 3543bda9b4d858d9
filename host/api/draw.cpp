#include "api/draw.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "api/choose_mode.h"
#include "api/record.h"
#include "engine/odprt/assign.h"
#include "engine/odprt/subtrees.h"
#include "engine/pdprt/render.h"
#include "engine/wavefront/channels.h"
#include "io/image/color.h"

namespace kdray::api {

namespace {

std::vector<pdprt::Device> places_on(State& state, const Job& job) {
  std::vector<pdprt::Device> places;
  for (Device& d : state.devices)
    places.push_back({&d.context, &d.buffers(), &d.programs, state.scheduler.schedule_for(d, job)});
  return places;
}

}  // namespace

FrameResult draw_pdprt(State& state, const Job& job) {
  pdprt::Task task{request_of(state, job)};
  task.division = job.options.division;
  task.max_film_bytes = state.ranks ? job.film_of_ranks : film_bytes(state, job);
  task.ranks = state.ranks.get();
  task.shared_frame = job.shared_frame;
  pdprt::Result result = pdprt::render(places_on(state, job), task);
  state.scheduler.remember(job.frame, result.tile_cost);
  state.speeds.take(job.frame).pdprt = mrays_per_s(result.counters.total(), result.render_seconds);
  return frame_result_of(std::move(result), state, job);
}

namespace {

// The wide form is what is divided, so that all walks but the binary tree's will do.
Traversal traversal_of(Traversal wanted, bool on_cpus) {
  if (wanted == Traversal::binary)
    throw Error(ErrorCode::usage,
                "odprt divides the wide form of the tree; take another traversal than binary, or mode pdprt");
  // Packets and batches are explicit vectors, for CPUs; elsewhere the lanes are work-items.
  return wanted == Traversal::automatic && !on_cpus ? Traversal::wide : wanted;
}

// Parts that fit into one piece of a device's memory, with all that goes with them, have no array that
// doesn't.
std::uint64_t memory_limit(const State& state, const RenderOptions& o) {
  const Device* const small = too_small_for_an_array(state);
  if (small == nullptr) return o.device_memory;
  const std::uint64_t piece = small->context.info().max_allocation;
  return o.device_memory > 0 ? std::min(o.device_memory, piece) : piece;
}

// Rays of a wave, where each of them has a work-item; 0 where they travel between slices: if some device
// wants these, and between ranks. What they travel through takes more memory than a wave of PDPRT.
std::uint32_t wave_rays(const State& state, const Job& job) {
  constexpr std::uint32_t kShare = 4;
  if (state.ranks) return 0;
  std::uint32_t least = ~0u;
  for (const Device& d : state.devices) {
    if (!d.global) return 0;
    least = std::min(least, state.scheduler.schedule_for(d, job, false).batch_size);
  }
  return std::max(least / kShare, 1u);
}

odprt::Request request_for(State& state, Job& job) {
  const RenderOptions& o = job.options;
  wavefront::Schedule schedule = state.scheduler.schedule_for(state.devices.first(), job, true);
  schedule.apply(job.frame, job.features);
  odprt::Request request{request_of(state, job)};
  for (Device& d : state.devices) {
    schedule.n_slices = std::max(schedule.n_slices, state.scheduler.schedule_for(d, job, true).n_slices);
    for (const cl::CommandQueue& queue : d.context.queues())
      request.queues.push_back({&d.context, queue, &d.programs, request.queues.size(), d.work_group});
  }
  request.wave_rays = wave_rays(state, job);
  request.traversal = traversal_of(o.traversal, !state.devices.first().global);
  request.balance = o.balance;
  request.n_slices = schedule.n_slices;
  request.table = odprt::alone(request.queues.size());
  if (state.ranks) {
    odprt::Joined joined = odprt::join(*state.ranks, request.queues.size(), schedule.n_slices);
    request.table = std::move(joined.table);
    request.n_slices = joined.n_slices;
  }
  request.ray_buffer = static_cast<std::uint32_t>(o.ray_buffer);
  request.device_memory = state.whole ? 0 : memory_limit(state, o);
  return request;
}

}  // namespace

FrameResult draw_odprt(State& state, Job& job) {
  const RenderOptions& o = job.options;
  if (o.device_memory > 0 && !o.channels.empty())
    throw Error(ErrorCode::usage, "channels need the whole scene on a device; set no limit for its memory");
  if (o.device_memory > 0 && state.ranks)
    throw Error(ErrorCode::usage,
                "with ranks each part of the scene stays where it is; take more ranks for --device-memory");
  if (state.whole) job.options.balance = Balance::sah;  // each rank divides what it holds
  const odprt::Request request = request_for(state, job);
  if (!state.divided)
    state.divided = std::make_unique<odprt::DividedScene>(state.scene.flat, state.scene.wide,
                                                          state.whole ? state.whole->ranks : nullptr);
  odprt::Result result = state.divided->render(request);
  state.speeds.take(job.frame).odprt = mrays_per_s(result.counters.total(), result.render_seconds);
  return frame_result_of(std::move(result), state, job);
}

namespace {

dvec3 vector_of(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

// The kernels' eye ray through a pixel's centre (raygen/primary.clh), in double.
dvec3 point_at(const layout::Frame& frame, std::uint32_t column, std::uint32_t row, double distance) {
  const double middle = frame.corner_grid ? 0 : 0.5;
  const double x = (frame.crop_x + column + middle) * frame.x_scale + frame.x_offset;
  const double y = (frame.crop_y + row + middle) * frame.y_scale + frame.y_offset;
  const dvec3 eye = vector_of(frame.eye), forward = vector_of(frame.forward);
  const dvec3 aside = vector_of(frame.right) * x + vector_of(frame.up) * y;
  if (frame.parallel) return eye + aside + safe_normalize(forward) * distance;
  return eye + safe_normalize(forward + aside) * distance;
}

float channel_of(std::uint32_t queue) {
  return queue == odprt::kEveryPart ? image::kEveryQueue : static_cast<float>(queue);
}

}  // namespace

std::vector<float> queues_by_tiles(const layout::Frame& frame, const Owners& owners) {
  const std::uint32_t n_tiles_x = (frame.width + owners.tile_width - 1) / owners.tile_width;
  std::vector<float> queues;
  queues.reserve(std::size_t{frame.width} * frame.height);
  for (std::uint32_t row = 0; row < frame.height; ++row)
    for (std::uint32_t column = 0; column < frame.width; ++column) {
      const std::uint32_t queue =
          owners.of_tiles[row / owners.tile_height * n_tiles_x + column / owners.tile_width];
      queues.push_back(queue == pdprt::kNobody ? image::kNoQueue : static_cast<float>(queue));
    }
  return queues;
}

std::vector<float> queues_by_subtrees(const State& state, const layout::Frame& frame, const Owners& owners,
                                      std::span<const float> depths) {
  const odprt::Locator locator(state.scene.wide, state.divided->cut());
  std::vector<float> queues(depths.size(), image::kNoQueue);
  tbb::parallel_for(std::uint32_t{0}, frame.height, [&](std::uint32_t row) {
    for (std::uint32_t column = 0; column < frame.width; ++column) {
      const std::size_t pixel = std::size_t{row} * frame.width + column;
      if (!std::isfinite(depths[pixel])) continue;
      const double distance = state.scene.geometry.space.local_length(depths[pixel]);
      const auto subtree = locator.find(vec3(point_at(frame, column, row, distance)));
      if (subtree) queues[pixel] = channel_of(owners.of_subtrees[*subtree]);
    }
  });
  return queues;
}

namespace {

image::Channel samples_channel(const Job& job, FrameResult& frame_result) {
  if (frame_result.samples) return {"samples", std::move(frame_result.samples->counts)};
  const std::size_t n_pixels = frame_result.rgb.size() / 3;
  return {"samples", std::vector<float>(n_pixels, static_cast<float>(job.frame.n_samples))};
}

}  // namespace

std::vector<image::Channel> channels_of(State& state, const Job& job, FrameResult& frame_result) {
  std::vector<std::string> traced = job.options.channels;
  const bool counted = std::erase(traced, "samples") > 0;
  const bool owned = std::erase(traced, "queue") > 0;
  // What was hit tells whose subtree it lies in.
  const bool by_depth = owned && frame_result.owners.of_tiles.empty();
  const bool only_for_that = by_depth && std::ranges::find(traced, "depth") == traced.end();
  if (only_for_that) traced.insert(traced.begin(), "depth");
  std::vector<image::Channel> channels;
  if (!traced.empty()) {
    std::vector<wavefront::ChannelQueue> queues;
    for (Device& device : state.devices)
      for (const cl::CommandQueue& queue : device.context.queues())
        queues.push_back({device.context, device.buffers(), device.programs, queue});
    channels = wavefront::render_channels(queues, job.frame, state.scene.geometry.space, job.features,
                                          job.options.precision, traced);
  }
  if (owned) {
    const auto depth = std::ranges::find(channels, "depth", &image::Channel::name);
    channels.push_back(
        {"queue", by_depth ? queues_by_subtrees(state, job.frame, frame_result.owners, depth->values)
                           : queues_by_tiles(job.frame, frame_result.owners)});
    if (only_for_that) channels.erase(channels.begin());
  }
  if (counted) channels.push_back(samples_channel(job, frame_result));
  return channels;
}

}  // namespace kdray::api
