#include "query/hit_lists.h"

#include <algorithm>

#include "base/error.h"
#include "base/memory.h"
#include "device/opencl_error.h"
#include "layout/features.h"
#include "layout/traversal.h"
#include "query/scene_arguments.h"

namespace kdray::query {

using layout::QueryHit;
using layout::QuerySpan;

namespace {

// Memory of this size on the host is kept when it is freed, and need not be touched anew by the next call
// (base/memory.h). What isn't used isn't touched.
constexpr std::size_t kKept = std::size_t{32} << 20;

std::size_t kept(std::size_t bytes) {
  return bytes < kLargePages ? bytes : std::max(bytes, kKept);
}

layout::Features features_of(const Target& target, const HitLists::Walk& walk) {
  return target.scene.features | (walk.masked ? KDRAY_FEATURE_MASKS : 0);
}

}  // namespace

HitLists::HitLists(const Target& target, const Walk& walk, const LocalSpace& space, std::size_t rays,
                   std::size_t hits)
    : target_(target),
      most_hits_(hits),
      chunked_(walk.traversal != Traversal::wide),
      collect_(target.programs.kernel<kernels::CollectHits>(features_of(target, walk), walk.traversal)),
      pack_(target.programs.kernel<kernels::PackHits>(features_of(target, walk), walk.traversal)),
      masked_(walk.masked),
      spare_(target.context),
      queue_(spare_.get()),
      spans_(target.context.buffer(CL_MEM_READ_WRITE, rays * sizeof(QuerySpan), "the rays' counts")),
      hits_(target.context.buffer(CL_MEM_READ_WRITE, kept(hits * sizeof(QueryHit)), "the rays' hits")) {
  using C = kernels::CollectHits;
  using P = kernels::PackHits;
  device::checked("finding hits", [&] {
    target.buffers.set_arguments(collect_);
    target.buffers.set_arguments(pack_);
    collect_.set(C::space, float4(space)).set(C::world_max, world_max(target.scene.geometry.bounds));
    collect_.set(C::primitive_masks, target.masks() != nullptr ? target.masks : spans_);
    collect_.set(C::spans, spans_).set(C::hits, hits_);
    pack_.set(P::space, float4(space)).set(P::spans, spans_).set(P::hits, hits_);
  });
}

void HitLists::unmap() noexcept {
  if (found_ != nullptr) clEnqueueUnmapMemObject(queue_(), spans_(), found_, 0, nullptr, nullptr);
  found_ = nullptr;
}

std::span<const QuerySpan> HitLists::find(const RaysGiven& given, bool any_length,
                                          std::span<const QuerySpan> after, std::uint32_t capacity) {
  using K = kernels::CollectHits;
  const auto& [rays, masks] = given;
  unmap();
  n_rays_ = rays.size();
  capacity_ = capacity;
  any_length_ = any_length;
  rays_ = target_.context.upload(rays.data(), rays.size_bytes(), nullptr, "the rays");
  if (masked_ && masks.empty()) all_bits_.assign(rays.size(), 0xffffffffu);
  const std::span<const std::uint32_t> ray_masks = masks.empty() ? all_bits_ : masks;
  masks_ = target_.context.upload(ray_masks.data(), ray_masks.size_bytes(), nullptr, "the rays' masks");
  after_ = target_.context.upload(after.data(), after.size_bytes(), nullptr, "where rays go on");
  device::checked("finding hits", [&] {
    collect_.set(K::rays, rays_).set(K::ray_masks, masks_).set(K::after, after_);
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

namespace {

// An array of the host's for kernels to write to: where the device works in the host's memory, as it is;
// elsewhere by way of a buffer of the device's.
class Written {
 public:
  Written(const device::Context& context, void* data, std::size_t bytes)
      : data_(data), bytes_(bytes), lent_(context.lend(data, bytes, "packed hits")) {
    if (!lent_()) own_ = context.buffer(CL_MEM_WRITE_ONLY, bytes, "packed hits");
  }
  const cl::Buffer& buffer() const { return lent_() ? lent_ : own_; }

  // Waits for it.
  void take(cl::CommandQueue& queue) {
    if (!lent_()) return static_cast<void>(queue.enqueueReadBuffer(own_, CL_TRUE, 0, bytes_, data_));
    void* const mapped = queue.enqueueMapBuffer(lent_, CL_TRUE, CL_MAP_READ, 0, bytes_);
    queue.enqueueUnmapMemObject(lent_, mapped);
  }

 private:
  void* data_;
  std::size_t bytes_;
  cl::Buffer lent_, own_;
};

}  // namespace

void HitLists::pack(std::span<const std::uint32_t> places, std::size_t n, const HitArrays& to) {
  using P = kernels::PackHits;
  const device::Context& context = target_.context;
  const cl::Buffer in_places =
      context.upload(places.data(), places.size_bytes(), nullptr, "the hits' places");
  Written t(context, to.t, n * 4), primitive(context, to.primitive, n * 4);
  Written u(context, to.u, n * 4), v(context, to.v, n * 4);
  device::checked("packing hits", [&] {
    pack_.set(P::n_rays, static_cast<cl_uint>(n_rays_)).set(P::capacity, capacity_);
    pack_.set(P::any_length, cl_uint{any_length_}).set(P::rays, rays_).set(P::places, in_places);
    pack_.set(P::t, t.buffer()).set(P::primitive, primitive.buffer());
    pack_.set(P::u, u.buffer()).set(P::v, v.buffer());
    pack_.launch(queue_, n_rays_, target_.work_group);
    for (Written* array : {&t, &primitive, &u, &v}) array->take(queue_);
    queue_.finish();  // the arrays may go
  });
}

}  // namespace kdray::query
