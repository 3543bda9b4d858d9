#include "engine/query/session.h"

#include <algorithm>

#include "base/error.h"
#include "device/opencl/opencl_error.h"
#include "engine/query/scene_arguments.h"
#include "layout/features.h"
#include "layout/traversal.h"

namespace kdray::query {

namespace {

layout::Features features_to_trace(const Target& target) {
  return target.scene.features | (target.masks() != nullptr ? KDRAY_FEATURE_MASKS : 0) |
         (target.filters ? KDRAY_FEATURE_FILTER : 0);
}

}  // namespace

void throw_failed_walk() {
  throw Error(ErrorCode::internal,
              "a ray met a primitive of a kind that its kernel lacks; please report it with the scene");
}

std::size_t Session::usual_chunk(const Target& target) {
  constexpr std::size_t kChunk = std::size_t{1} << 16, kGlobalChunk = std::size_t{1} << 20;
  return target.global ? kGlobalChunk : kChunk;
}

Session::Session(const Target& target, std::size_t chunk)
    : masked_(target.masks() != nullptr),
      placed_(!target.scene.flat.instances.empty()),
      queue_(target.context, target.sub_device),
      stage_(target.programs.kernel<kernels::TraceQuery>(features_to_trace(target), target.walk(),
                                                         target.precision)),
      work_group_(target.work_group),
      chunked_(target.walk() != Traversal::binary && target.walk() != Traversal::wide) {
  using K = kernels::TraceQuery;
  device::checked("getting ready to trace rays", [&] {
    rays_ = {target.context, CL_MEM_READ_ONLY, chunk, "the rays"};
    hits_ = {target.context, CL_MEM_WRITE_ONLY, chunk, "the hits"};
    masks_ = {target.context, CL_MEM_READ_ONLY, masked_ ? chunk : 1, "the rays' masks"};
    instances_ = {target.context, CL_MEM_WRITE_ONLY, placed_ ? chunk : 1, "the hits' instances"};
    set_scene_arguments(stage_, target);
    if (target.programs.walks_alone(K::kFile, target.walk()))
      stage_.set(K::wide_nodes, target.buffers.compressed_nodes());
    stage_.set(K::space, float4(vec3(0), 1)).set(K::any_length, cl_uint{0});
    stage_.set(K::rays, rays_.buffer()).set(K::hits, hits_.buffer());
    stage_.set(K::hit_instances, instances_.buffer());
    stage_.set(K::primitive_masks, masked_ ? target.masks : masks_.buffer());
    stage_.set(K::ray_masks, masks_.buffer());
    stage_.set(K::any_hit, cl_uint{0}).set(K::as_refs, cl_uint{0});
  });
  const device::AtWork compiling(target.context.builds());
  warm_up(1);
}

void Session::warm_up(std::size_t n) {
  std::fill_n(hits_.data(), n, layout::QueryHit{});
  device::checked("getting ready to trace rays", [&] { enqueue(0, n); });
  finish();
}

bool Session::settle() noexcept {
  return !started_ || clFinish(queue_.get()()) == CL_SUCCESS;
}

void Session::enqueue(std::size_t n, std::size_t n_items) {
  using K = kernels::TraceQuery;
  stage_.set(K::n_rays, static_cast<cl_uint>(n));
  chunked_ ? stage_.launch(queue_.get(), (n_items + KDRAY_CHUNK - 1) / KDRAY_CHUNK, 1)
           : stage_.launch(queue_.get(), n_items, work_group_);
}

void Session::load(std::size_t n, bool any_hit, bool as_refs) {
  using K = kernels::TraceQuery;
  started_ = true;
  n_started_ = n;
  device::checked("tracing rays", [&] {
    stage_.set(K::any_hit, cl_uint{any_hit}).set(K::as_refs, cl_uint{as_refs});
    rays_.send(queue_.get(), n);
    if (masked_) masks_.send(queue_.get(), n);
  });
}

void Session::launch() {
  device::checked("tracing rays", [&] {
    enqueue(n_started_, n_started_);
    queue_.get().flush();
  });
}

void Session::finish() {
  device::checked("tracing rays", [&] {
    queue_.get().finish();
    stage_.forget_launches();
  });
}

std::span<const layout::QueryHit> Session::wait() {
  finish();
  device::checked("tracing rays", [&] {
    hits_.fetch(queue_.get(), n_started_);
    if (placed_) instances_.fetch(queue_.get(), n_started_);
  });
  started_ = false;
  return hits_.first(n_started_);
}

}  // namespace kdray::query
