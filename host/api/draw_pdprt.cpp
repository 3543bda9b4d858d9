#include "api/draw_pdprt.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "api/choose_mode.h"
#include "api/record.h"
#include "engine/pdprt/render.h"

namespace kdray::api {

namespace {

std::vector<pdprt::Device> places_on(State& state, const Job& job) {
  std::vector<pdprt::Device> places;
  for (Device& d : state.devices)
    places.push_back({&d.context, &d.buffers(), &d.programs, state.scheduler.schedule_for(d, job)});
  // The frame has one size of batches for all devices.
  const auto batch = [](const pdprt::Device& place) { return place.schedule.batch_size; };
  const std::uint32_t smallest = batch(*std::ranges::min_element(places, {}, batch));
  for (pdprt::Device& place : places) place.schedule.batch_size = smallest;
  return places;
}

// One line for each queue that failed.
std::vector<std::string> warnings_of(const pdprt::Result& result) {
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < result.queues.size(); ++i)
    if (const pdprt::QueueResult& queue = result.queues[i]; !queue.failure.empty())
      warnings.push_back(
          fmt::format("queue {} ({}){} failed: {}; the other queues rendered the {} tiles it had taken", i,
                      queue.device, queue.rank > 0 ? fmt::format(", which is rank {}'s,", queue.rank) : "",
                      queue.failure, queue.tiles_lost));
  return warnings;
}

// Each queue sees the whole scene.
void add_memory(FrameResult& frame_result, const pdprt::Result& result, std::uint64_t scene_bytes) {
  frame_result.frame_bytes = 0;
  for (const pdprt::QueueResult& queue : result.queues) {
    *frame_result.frame_bytes += queue.device_bytes;
    frame_result.memory_of_queues.push_back({scene_bytes, queue.device_bytes});
  }
}

}  // namespace

FrameResult draw_pdprt(State& state, const Job& job) {
  const std::size_t max_film_bytes = state.ranks ? job.film_of_ranks : film_bytes(state, job);
  pdprt::Result result = pdprt::render(places_on(state, job), {.frame = job.frame,
                                                               .features = job.features,
                                                               .adaptive_target = job.options.adaptive_target,
                                                               .division = job.options.division,
                                                               .progress = job.options.progress,
                                                               .fault_injector = &state.fault_injector,
                                                               .timeline = job.timeline,
                                                               .max_film_bytes = max_film_bytes,
                                                               .checkpoint = job.checkpoint.get(),
                                                               .ranks = state.ranks.get(),
                                                               .shared_frame = job.shared_frame});
  state.scheduler.remember(job.frame, result.tile_cost);
  state.speeds.take(job.frame).pdprt = mrays_per_s(result.counters.total(), result.render_seconds);
  FrameResult frame_result;
  frame_result.division = division_of(result, job, state.devices.first().global);
  if (state.ranks) tell_of_ranks(frame_result.division, result.queues, *state.ranks);
  add_memory(frame_result, result, state.scene_bytes);
  frame_result.warnings = warnings_of(result);
  frame_result.owners = {result.tile_width, result.tile_height, std::move(result.tile_queues)};
  frame_result.image = std::move(result.image);
  frame_result.samples = std::move(result.samples);
  frame_result.counters = result.counters;
  frame_result.stage_seconds = std::move(result.stage_seconds);
  frame_result.render_seconds = result.render_seconds;
  return frame_result;
}

}  // namespace kdray::api
