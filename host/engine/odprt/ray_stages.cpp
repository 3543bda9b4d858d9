#include "engine/odprt/worker.h"

#include <algorithm>

#include "layout/features.h"

namespace kdray::odprt {

namespace {

constexpr Traversal kNone = Traversal::binary, kWalk = Traversal::wide;  // parts have no binary tree

// Returns the programs once all that are wanted are built, side by side.
wavefront::Programs& built(wavefront::Programs& programs, layout::Features features) {
  using namespace kernels;
  std::vector<wavefront::Programs::Wanted> wanted = {{TravelPlan::kFile, features, kNone},
                                                     {TravelAdmit::kFile, features, kNone},
                                                     {TravelTrace::kFile, features, kWalk},
                                                     {TravelShade::kFile, features, kNone},
                                                     {TravelReceive::kFile, features, kNone}};
  if (features & KDRAY_FEATURE_LIGHTS) wanted.push_back({TravelShadow::kFile, features, kWalk});
  programs.build(wanted);
  return programs;
}

}  // namespace

RayStages::RayStages(wavefront::Programs& programs, layout::Features features, std::size_t work_group)
    : work_group_(work_group),
      plan_(built(programs, features).kernel<kernels::TravelPlan>(features, kNone)),
      admit_(programs.kernel<kernels::TravelAdmit>(features, kNone)),
      trace_(programs.kernel<kernels::TravelTrace>(features, kWalk)),
      shade_(programs.kernel<kernels::TravelShade>(features, kNone)),
      receive_(programs.kernel<kernels::TravelReceive>(features, kNone)) {
  if (features & KDRAY_FEATURE_LIGHTS)
    shadow_.emplace(programs.kernel<kernels::TravelShadow>(features, kWalk));
}

// Shadow rays from elsewhere are traced in the first round of a wave without a batch.
void RayStages::launch_lights(cl::CommandQueue& queue, const layout::Frame& frame) {
  cl_uint first = 0;
  do {
    shade_.set(kernels::TravelShade::first_light, first);
    shade_.launch(queue, frame.batch_size, work_group_);
    if (shadow_) {
      shadow_->set(kernels::TravelShadow::first_light, first);
      shadow_->launch(queue, std::size_t{frame.batch_size} * std::max(frame.light_batch, 1u), work_group_);
    }
    first += frame.light_batch;
  } while (frame.light_batch > 0 && first < frame.n_lights);
}

void RayStages::launch(cl::CommandQueue& queue, const layout::Frame& frame, std::uint32_t n_waves,
                       std::uint32_t n_tiles, const Outbox& outbox) {
  const auto fills = [&]<class K>(wavefront::Stage<K>& stage) {
    KDRAY_SET_WHERE_TAKEN(K, stage, sent_rays, outbox.rays());
    KDRAY_SET_WHERE_TAKEN(K, stage, sent_shadow_rays, outbox.shadow_rays());
    KDRAY_SET_WHERE_TAKEN(K, stage, sent_counts, outbox.counts());
  };
  fills(plan_), fills(trace_);
  if (shadow_) fills(*shadow_);
  using Plan = kernels::TravelPlan;
  plan_.set(Plan::n_tiles, cl_uint{n_tiles}).set(Plan::n_waves, cl_uint{n_waves});
  for (cl_uint wave = 0; wave < n_waves; ++wave) {
    plan_.set(Plan::wave, wave).launch(queue, 1, 1);
    admit_.launch(queue, frame.batch_size, work_group_);
    trace_.launch(queue, frame.batch_size, work_group_);
    launch_lights(queue, frame);
  }
  plan_.set(Plan::wave, cl_uint{n_waves}).launch(queue, 1, 1);
}

void RayStages::receive(cl::CommandQueue& queue, const Outbox& outbox, std::uint32_t place) {
  using K = kernels::TravelReceive;
  const std::uint64_t n = std::max(outbox.n_rays(place), outbox.n_shadow_rays(place));
  if (n == 0) return;
  outbox.set_arguments(receive_);
  receive_.set(K::place, place).set(K::n_places, outbox.shape().n_places);
  receive_.set(K::ray_capacity, outbox.shape().ray_capacity);
  receive_.set(K::shadow_capacity, outbox.shape().shadow_capacity);
  receive_.launch(queue, n, work_group_);
}

std::map<std::string, double> RayStages::seconds() {
  std::map<std::string, double> seconds = {{"admit", plan_.collect_seconds() + admit_.collect_seconds()},
                                           {"trace_closest", trace_.collect_seconds()},
                                           {"shade", shade_.collect_seconds()},
                                           {"route", receive_.collect_seconds()}};
  if (shadow_) seconds["trace_shadow"] = shadow_->collect_seconds();
  return seconds;
}

}  // namespace kdray::odprt
