#include "api/draw_pdprt.h"

#include <algorithm>
#include <utility>
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

}  // namespace kdray::api
