#include "query/hit_lists.h"

#include <algorithm>

#include "base/error.h"
#include "device/opencl_error.h"
#include "layout/traversal.h"
#include "query/launch.h"

namespace kdray::query {

using layout::QueryHit;
using layout::QuerySpan;

HitLists::HitLists(const Target& target, Traversal traversal, const LocalSpace& space, std::size_t rays,
                   std::size_t hits)
    : target_(target),
      most_hits_(hits),
      chunked_(traversal != Traversal::wide),
      collect_(target.programs.kernel<kernels::CollectHits>(target.scene.features, traversal)),
      queue_(target.context.queues().front()),
      spans_(target.context.buffer(CL_MEM_READ_WRITE, rays * sizeof(QuerySpan), "the rays' counts")),
      hits_(target.context.buffer(CL_MEM_READ_WRITE, hits * sizeof(QueryHit), "the rays' hits")) {
  using K = kernels::CollectHits;
  device::checked("finding hits", [&] {
    target.buffers.set_arguments(collect_);
    collect_.set(K::space, float4(space)).set(K::world_max, world_max(target.scene.geometry.bounds));
    collect_.set(K::spans, spans_).set(K::hits, hits_);
  });
}

void HitLists::unmap() noexcept {
  if (found_ != nullptr) clEnqueueUnmapMemObject(queue_(), spans_(), found_, 0, nullptr, nullptr);
  found_ = nullptr;
}

std::span<const QuerySpan> HitLists::find(std::span<const Ray> rays, bool any_length,
                                          std::span<const QuerySpan> after, std::uint32_t capacity) {
  using K = kernels::CollectHits;
  unmap();
  n_rays_ = rays.size();
  capacity_ = capacity;
  rays_ = target_.context.upload(rays.data(), rays.size_bytes(), nullptr, "the rays");
  after_ = target_.context.upload(after.data(), after.size_bytes(), nullptr, "where rays go on");
  device::checked("finding hits", [&] {
    collect_.set(K::rays, rays_).set(K::after, after_);
    collect_.set(K::n_rays, static_cast<cl_uint>(n_rays_)).set(K::capacity, capacity);
    collect_.set(K::goes_on, cl_uint{!after.empty()}).set(K::any_length, cl_uint{any_length});
    chunked_ ? collect_.launch(queue_, (n_rays_ + KDRAY_CHUNK - 1) / KDRAY_CHUNK, 1)
             : collect_.launch(queue_, n_rays_, target_.work_group);
    found_ = queue_.enqueueMapBuffer(spans_, CL_TRUE, CL_MAP_READ, 0, n_rays_ * sizeof(QuerySpan));
  });
  const std::span<const QuerySpan> found(static_cast<const QuerySpan*>(found_), n_rays_);
  if (std::any_of(found.begin(), found.end(),
                  [](const QuerySpan& s) { return s.n_hits == KDRAY_SPAN_INVALID; }))
    throw Error(ErrorCode::internal,
                "a ray met a primitive of a kind that its kernel lacks; please report it with the scene");
  return found;
}

void HitLists::make_room_for_packed() {
  if (pack_) return;
  using K = kernels::PackHits;
  pack_.emplace(target_.programs.kernel<K>(target_.scene.features));
  for (cl::Buffer* buffer : {&t_, &primitive_, &u_, &v_})
    *buffer = target_.context.buffer(CL_MEM_WRITE_ONLY, most_hits_ * 4, "packed hits");
  pack_->set(K::spans, spans_).set(K::hits, hits_);
  pack_->set(K::t, t_).set(K::primitive, primitive_).set(K::u, u_).set(K::v, v_);
}

void HitLists::pack(std::span<const std::uint32_t> places, std::size_t n, const HitArrays& to) {
  using K = kernels::PackHits;
  const cl::Buffer in_places =
      target_.context.upload(places.data(), places.size_bytes(), nullptr, "the hits' places");
  device::checked("packing hits", [&] {
    make_room_for_packed();
    pack_->set(K::n_rays, static_cast<cl_uint>(n_rays_)).set(K::capacity, capacity_);
    pack_->set(K::places, in_places);
    pack_->launch(queue_, n_rays_, target_.work_group);
    queue_.enqueueReadBuffer(t_, CL_FALSE, 0, n * 4, to.t);
    queue_.enqueueReadBuffer(primitive_, CL_FALSE, 0, n * 4, to.primitive);
    queue_.enqueueReadBuffer(u_, CL_FALSE, 0, n * 4, to.u);
    queue_.enqueueReadBuffer(v_, CL_TRUE, 0, n * 4, to.v);
  });
}

std::span<const QueryHit> HitLists::read() {
  read_.resize(n_rays_ * capacity_);
  device::checked("reading hits", [&] {
    queue_.enqueueReadBuffer(hits_, CL_TRUE, 0, read_.size() * sizeof read_[0], read_.data());
  });
  return read_;
}

}  // namespace kdray::query
