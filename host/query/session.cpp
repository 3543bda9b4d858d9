#include "query/session.h"

#include <algorithm>

#include "base/error.h"
#include "device/host_memory.h"
#include "device/opencl_error.h"
#include "layout/features.h"
#include "layout/traversal.h"
#include "query/scene_arguments.h"

namespace kdray::query {

namespace {

constexpr std::size_t kChunk = std::size_t{1} << 17, kGlobalChunk = std::size_t{1} << 20;

Traversal traversal_of(const Target& target) {
  return target.global ? Traversal::wide : Traversal::automatic;
}

layout::Features features_to_trace(const Target& target) {
  return target.scene.features | (target.masks() != nullptr ? KDRAY_FEATURE_MASKS : 0);
}

}  // namespace

template <class T>
cl::Buffer Session::buffer_of(Array<T>& array, cl_mem_flags flags, const char* what) {
  if (!in_place_) return context_->buffer(flags, array.bytes(), what);
  return device::buffer_over(context_->get(), flags, array.data(), array.bytes(), array.owner());
}

Session::Session(const Target& target)
    : context_(&target.context),
      masked_(target.masks() != nullptr),
      queue_(target.context),
      stage_(target.programs.kernel<kernels::TraceQuery>(features_to_trace(target), traversal_of(target))),
      work_group_(target.work_group),
      chunked_(!target.global),
      in_place_(target.context.works_in_host_memory()),
      rays_(target.global ? kGlobalChunk : kChunk),
      hits_(rays_.size()),
      masks_(masked_ ? rays_.size() : 1) {
  using K = kernels::TraceQuery;
  device::checked("getting ready to trace rays", [&] {
    ray_buffer_ = buffer_of(rays_, CL_MEM_READ_ONLY, "the rays");
    hit_buffer_ = buffer_of(hits_, CL_MEM_WRITE_ONLY, "the hits");
    mask_buffer_ = buffer_of(masks_, CL_MEM_READ_ONLY, "the rays' masks");
    set_scene_arguments(stage_, target);
    stage_.set(K::space, float4(vec3(0), 1)).set(K::any_length, cl_uint{0});
    stage_.set(K::rays, ray_buffer_).set(K::hits, hit_buffer_);
    stage_.set(K::primitive_masks, masked_ ? target.masks : mask_buffer_).set(K::ray_masks, mask_buffer_);
    // PoCL compiles a kernel for good at its first launch.
    const device::AtWork compiling(context_->builds());
    stage_.set(K::any_hit, cl_uint{0}).set(K::as_refs, cl_uint{0});
    launch(0);
  });
}

void Session::launch(std::size_t n) {
  using K = kernels::TraceQuery;
  stage_.set(K::n_rays, static_cast<cl_uint>(n));
  const std::size_t items = std::max<std::size_t>(n, 1);
  chunked_ ? stage_.launch(queue_.get(), (items + KDRAY_CHUNK - 1) / KDRAY_CHUNK, 1)
           : stage_.launch(queue_.get(), items, work_group_);
  queue_.get().finish();
  stage_.forget_launches();
}

std::span<const layout::QueryHit> Session::trace(std::size_t n, bool any_hit, bool as_refs) {
  using K = kernels::TraceQuery;
  sound_ = false;
  device::checked("tracing rays", [&] {
    stage_.set(K::any_hit, cl_uint{any_hit}).set(K::as_refs, cl_uint{as_refs});
    if (!in_place_) {
      queue_.get().enqueueWriteBuffer(ray_buffer_, CL_TRUE, 0, n * sizeof rays_[0], rays_.data());
      if (masked_)
        queue_.get().enqueueWriteBuffer(mask_buffer_, CL_TRUE, 0, n * sizeof masks_[0], masks_.data());
    }
    launch(n);
    if (!in_place_)
      queue_.get().enqueueReadBuffer(hit_buffer_, CL_TRUE, 0, n * sizeof hits_[0], hits_.data());
  });
  sound_ = true;
  const std::span<const layout::QueryHit> hits(hits_.data(), n);
  if (std::any_of(hits.begin(), hits.end(),
                  [](const layout::QueryHit& h) { return h.primitive == kFailedWalk; }))
    throw Error(ErrorCode::internal,
                "a ray met a primitive of a kind that its kernel lacks; please report it with the scene");
  return hits;
}

Sessions::Borrowed Sessions::borrow() {
  std::unique_ptr<Session> session;
  if (const std::lock_guard lock(mutex_); !free_.empty()) {
    session = std::move(free_.back());
    free_.pop_back();
  }
  if (!session) session = std::make_unique<Session>(target_);  // which may compile: others go on
  return {session.release(), Give(this)};
}

void Sessions::take_back(std::unique_ptr<Session> session) {
  if (!session->is_sound()) return;  // something may still be running on it
  const std::lock_guard lock(mutex_);
  try {
    free_.push_back(std::move(session));
  } catch (const std::bad_alloc&) {  // the next one is made anew
  }
}

}  // namespace kdray::query
