#include "api/draw_odprt.h"

#include <algorithm>
#include <utility>

#include "api/choose_mode.h"
#include "api/record.h"

namespace kdray::api {

namespace {

// The wide form is what is divided, so that all walks but the binary tree's will do.
Traversal traversal_of(Traversal wanted, bool on_cpus) {
  if (wanted == Traversal::binary)
    throw Error(
        ErrorCode::usage,
        "odprt divides the wide form of the tree; take another --traversal than binary, or --mode pdprt");
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
    throw Error(ErrorCode::usage, "--aov needs the whole scene on a device; leave --device-memory out");
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

}  // namespace kdray::api
