#include "query/hit_lists.h"

#include <algorithm>

#include "base/error.h"
#include "device/opencl_error.h"
#include "layout/traversal.h"
#include "query/check_rays.h"
#include "query/launch.h"

namespace kdray::query {

HitLists::HitLists(const Target& target, Traversal traversal, const LocalSpace& space, std::size_t rays,
                   std::size_t hits)
    : target_(target),
      most_hits_(hits),
      chunked_(traversal != Traversal::wide),
      collect_(target.programs.kernel<kernels::CollectHits>(target.scene.features, traversal)) {
  using K = kernels::CollectHits;
  const device::Context& context = target.context;
  rays_ = context.buffer(CL_MEM_READ_ONLY, rays * sizeof(Ray), "the rays");
  after_ = context.buffer(CL_MEM_READ_ONLY, rays * sizeof(layout::QuerySpan), "where rays go on");
  spans_ = context.buffer(CL_MEM_READ_WRITE, rays * sizeof(layout::QuerySpan), "the rays' counts");
  hits_ = context.sparse_buffer(CL_MEM_READ_WRITE, hits * sizeof(layout::QueryHit), "the rays' hits");
  target.buffers.set_arguments(collect_);
  collect_.set(K::space, float4(space)).set(K::world_max, world_max(target.scene.geometry.bounds));
  collect_.set(K::rays, rays_).set(K::after, after_).set(K::spans, spans_).set(K::hits, hits_);
}

std::span<const layout::QuerySpan> HitLists::find(std::span<const Ray> rays,
                                                  std::span<const layout::QuerySpan> after,
                                                  std::uint32_t capacity) {
  using K = kernels::CollectHits;
  n_rays_ = rays.size();
  capacity_ = capacity;
  found_.resize(n_rays_);
  device::checked("finding hits", [&] {
    cl::CommandQueue queue = target_.context.queues().front();
    queue.enqueueWriteBuffer(rays_, CL_FALSE, 0, rays.size_bytes(), rays.data());
    if (!after.empty()) queue.enqueueWriteBuffer(after_, CL_FALSE, 0, after.size_bytes(), after.data());
    collect_.set(K::n_rays, static_cast<cl_uint>(n_rays_)).set(K::capacity, capacity);
    collect_.set(K::goes_on, cl_uint{!after.empty()});
    collect_.set(K::any_length, cl_uint{!std::all_of(rays.begin(), rays.end(), is_ordinary)});
    chunked_ ? collect_.launch(queue, (n_rays_ + KDRAY_CHUNK - 1) / KDRAY_CHUNK, 1)
             : collect_.launch(queue, n_rays_, target_.work_group);
    queue.enqueueReadBuffer(spans_, CL_TRUE, 0, n_rays_ * sizeof found_[0], found_.data());
  });
  if (std::any_of(found_.begin(), found_.end(), [](const auto& s) { return s.n_hits == KDRAY_SPAN_INVALID; }))
    throw Error(ErrorCode::internal,
                "a ray met a primitive of a kind that its kernel lacks; please report it with the scene");
  return found_;
}

// Room for packed hits is made when it is asked for.
cl::Buffer& HitLists::packed(cl::Buffer& buffer) {
  if (!buffer()) buffer = target_.context.sparse_buffer(CL_MEM_WRITE_ONLY, most_hits_ * 4, "packed hits");
  return buffer;
}

void HitLists::pack(std::span<const std::uint32_t> places, std::size_t n, const HitArrays& to) {
  using K = kernels::PackHits;
  wavefront::Stage stage(target_.programs.kernel<K>(target_.scene.features));
  device::checked("packing hits", [&] {
    if (!places_()) places_ = target_.context.buffer(CL_MEM_READ_ONLY, places.size_bytes(), "hits' places");
    cl::CommandQueue queue = target_.context.queues().front();
    queue.enqueueWriteBuffer(places_, CL_FALSE, 0, places.size_bytes(), places.data());
    stage.set(K::n_rays, static_cast<cl_uint>(n_rays_)).set(K::capacity, capacity_);
    stage.set(K::spans, spans_).set(K::places, places_).set(K::hits, hits_);
    stage.set(K::t, packed(t_)).set(K::primitive, packed(primitive_));
    stage.set(K::u, packed(u_)).set(K::v, packed(v_));
    stage.launch(queue, n_rays_, target_.work_group);
    queue.enqueueReadBuffer(t_, CL_FALSE, 0, n * 4, to.t);
    queue.enqueueReadBuffer(primitive_, CL_FALSE, 0, n * 4, to.primitive);
    queue.enqueueReadBuffer(u_, CL_FALSE, 0, n * 4, to.u);
    queue.enqueueReadBuffer(v_, CL_TRUE, 0, n * 4, to.v);
  });
}

std::span<const layout::QueryHit> HitLists::read() {
  read_.resize(n_rays_ * capacity_);
  device::checked("reading hits", [&] {
    target_.context.queues().front().enqueueReadBuffer(hits_, CL_TRUE, 0, read_.size() * sizeof read_[0],
                                                       read_.data());
  });
  return read_;
}

}  // namespace kdray::query
