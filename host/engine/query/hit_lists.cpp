#include "engine/query/hit_lists.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/error.h"
#include "device/opencl/opencl_error.h"
#include "engine/query/scene_arguments.h"
#include "engine/query/surface.h"
#include "layout/features.h"
#include "layout/traversal.h"

namespace kdray::query {

using layout::QueryHit;
using layout::QuerySpan;

namespace {

// An array of fewer elements is copied: that takes less than a buffer of its own.
constexpr std::size_t kFewElements = 4096;
// So few hits the host packs itself, where it has them: that takes less than a launch.
constexpr std::size_t kFewHits = 2048;

layout::Features features_of(const Target& target, const HitLists::Walk& walk) {
  return target.scene.features | (walk.masked ? KDRAY_FEATURE_MASKS : 0) |
         (target.filters ? KDRAY_FEATURE_FILTER : 0);
}

}  // namespace

HitLists::HitLists(const Target& target, const Walk& walk, const LocalSpace& space)
    : target_(target),
      chunked_(walk.traversal != Traversal::wide),
      collect_(target.programs.kernel<kernels::CollectHits>(features_of(target, walk), walk.traversal)),
      pack_(target.programs.kernel<kernels::PackHits>(features_of(target, walk), walk.traversal)),
      masked_(walk.masked),
      placed_(!target.scene.flat.instances.empty()),
      spare_(target.context, target.sub_device),
      queue_(spare_.get()),
      scale_(static_cast<float>(space.scale)) {
  using C = kernels::CollectHits;
  using P = kernels::PackHits;
  device::checked("finding hits", [&] {
    target.buffers.set_arguments(collect_);
    target.buffers.set_arguments(pack_);
    collect_.set(C::space, float4(space)).set(C::world_max, world_max(target.scene.geometry.bounds));
    pack_.set(P::space, float4(space));
  });
}

void HitLists::reserve(std::size_t rays, std::size_t hits) {
  using C = kernels::CollectHits;
  using P = kernels::PackHits;
  if (rays <= spans_.size() && hits <= hits_.size()) return;
  device::checked("finding hits", [&] {
    if (rays > spans_.size())
      spans_ = {target_.context, CL_MEM_READ_WRITE, std::bit_ceil(rays), "the rays' counts"};
    if (hits > hits_.size()) {
      const std::size_t n = std::bit_ceil(std::max(hits, kFewElements));
      hits_ = {target_.context, CL_MEM_READ_WRITE, n, "the rays' hits"};
      instances_ = {target_.context, CL_MEM_READ_WRITE, placed_ ? n : 1, "the hits' instances"};
    }
    collect_.set(C::primitive_masks, target_.masks() != nullptr ? target_.masks : spans_.buffer());
    collect_.set(C::spans, spans_.buffer()).set(C::hits, hits_.buffer());
    pack_.set(P::spans, spans_.buffer()).set(P::hits, hits_.buffer());
    collect_.set(C::hit_instances, instances_.buffer());
    pack_.set(P::hit_instances, instances_.buffer());
  });
}

template <class T>
const cl::Buffer& HitLists::Given<T>::take(const Target& target, cl::CommandQueue& queue,
                                           std::span<const T> values, const char* what) {
  if (values.size() > kFewElements)
    return large = target.context.upload(values.data(), values.size_bytes(), nullptr, what);
  large = cl::Buffer();
  if (kept.buffer()() == nullptr) kept = {target.context, CL_MEM_READ_ONLY, kFewElements, what};
  std::copy(values.begin(), values.end(), kept.data());
  kept.send(queue, values.size());
  return kept.buffer();
}

std::span<const QuerySpan> HitLists::find(const RaysGiven& given, bool any_length,
                                          std::span<const QuerySpan> after, std::uint32_t capacity) {
  using K = kernels::CollectHits;
  const std::span<const Ray> rays = given.rays;
  const std::span<const std::uint32_t> masks = given.masks;
  given_ = rays;
  n_rays_ = rays.size();
  capacity_ = capacity;
  any_length_ = any_length;
  reserve(n_rays_, n_rays_ * capacity);
  if (masked_ && masks.empty()) all_bits_.assign(rays.size(), 0xffffffffu);
  const std::span<const std::uint32_t> ray_masks = masks.empty() ? all_bits_ : masks;
  device::checked("finding hits", [&] {
    collect_.set(K::rays, rays_.take(target_, queue_, rays, "the rays"));
    collect_.set(K::ray_masks, masks_.take(target_, queue_, ray_masks, "the rays' masks"));
    collect_.set(K::after, after_.take(target_, queue_, after, "where rays go on"));
    collect_.set(K::n_rays, static_cast<cl_uint>(n_rays_)).set(K::capacity, capacity);
    collect_.set(K::goes_on, cl_uint{!after.empty()}).set(K::any_length, cl_uint{any_length});
    chunked_ ? collect_.launch(queue_, (n_rays_ + KDRAY_CHUNK - 1) / KDRAY_CHUNK, 1)
             : collect_.launch(queue_, n_rays_, target_.work_group);
    queue_.finish();
    collect_.forget_launches();
    spans_.fetch(queue_, n_rays_);
  });
  const std::span<const QuerySpan> found = spans_.first(n_rays_);
  if (std::any_of(found.begin(), found.end(),
                  [](const QuerySpan& s) { return s.n_hits == KDRAY_SPAN_INVALID; }))
    throw Error(ErrorCode::internal,
                "a ray met a primitive of a kind that its kernel lacks; please report it with the scene");
  return found;
}

template <class T>
const cl::Buffer& HitLists::Taken<T>::place(const device::Context& context, T* to, std::size_t n) {
  lent = false;
  if (n <= kFewElements) {
    large = cl::Buffer();
    if (kept.buffer()() == nullptr) kept = {context, CL_MEM_WRITE_ONLY, kFewElements, "packed hits"};
    return kept.buffer();
  }
  large = context.lend(to, n * sizeof(T), "packed hits");
  lent = large() != nullptr;
  if (!lent) large = context.buffer(CL_MEM_WRITE_ONLY, n * sizeof(T), "packed hits");
  return large;
}

// Waits for it.
template <class T>
void HitLists::Taken<T>::take(cl::CommandQueue& queue, T* to, std::size_t n) {
  if (n <= kFewElements) {
    queue.finish();
    kept.fetch(queue, n);
    std::copy_n(kept.data(), n, to);
  } else if (lent) {
    void* const mapped = queue.enqueueMapBuffer(large, CL_TRUE, CL_MAP_READ, 0, n * sizeof(T));
    queue.enqueueUnmapMemObject(large, mapped);
  } else {
    queue.enqueueReadBuffer(large, CL_TRUE, 0, n * sizeof(T), to);
  }
}

namespace {

// The kernels do the same (query.clh).
float power_of_two(int exponent) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(exponent + 127) << 23);
}
float scale_t(float t, int exponent) {
  const int half_of_it = exponent >> 1;
  return t * power_of_two(half_of_it) * power_of_two(exponent - half_of_it);
}
int length_exponent(const Ray& ray) {
  const auto& d = ray.direction;
  const float largest = std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])});
  const int e = static_cast<int>(std::clamp(std::bit_cast<std::uint32_t>(largest) >> 23, 1u, 253u)) - 127;
  return e >= -8 && e < 8 ? 0 : e;
}

}  // namespace

// What pack_hits does, on the host.
void HitLists::pack_here(std::span<const std::uint32_t> places, bool as_refs, const HitArrays& to) {
  const int space = static_cast<int>(std::bit_cast<std::uint32_t>(scale_) >> 23) - 127;
  for (std::size_t i = 0; i < n_rays_; ++i) {
    const int exponent = -(any_length_ ? length_exponent(given_[i]) : 0) - space;
    const QueryHit* const hits = hits_.data() + i * capacity_;
    const std::uint32_t n = spans_.data()[i].n_hits, first = places[i];
    for (std::uint32_t k = 0; k < n; ++k) {
      to.t[first + k] = scale_t(hits[k].t, exponent);
      const auto ref = static_cast<std::uint32_t>(hits[k].primitive);
      to.primitive[first + k] = as_refs ? ref : number_of(target_.scene.flat, ref);
      to.u[first + k] = hits[k].u;
      to.v[first + k] = hits[k].v;
      if (placed_) to.instance[first + k] = instances_.data()[i * capacity_ + k] - 1;
    }
  }
}

void HitLists::pack(std::span<const std::uint32_t> places, std::size_t n, bool as_refs, const HitArrays& to) {
  using P = kernels::PackHits;
  const device::Context& context = target_.context;
  if (n <= kFewHits && n_rays_ <= kFewHits && hits_.is_in_place()) return pack_here(places, as_refs, to);
  device::checked("packing hits", [&] {
    pack_.set(P::n_rays, static_cast<cl_uint>(n_rays_)).set(P::capacity, capacity_);
    pack_.set(P::any_length, cl_uint{any_length_}).set(P::as_refs, cl_uint{as_refs});
    pack_.set(P::rays, n_rays_ > kFewElements ? rays_.large : rays_.kept.buffer());
    pack_.set(P::places, places_.take(target_, queue_, places, "the hits' places"));
    pack_.set(P::t, t_.place(context, to.t, n)).set(P::primitive, primitive_.place(context, to.primitive, n));
    pack_.set(P::u, u_.place(context, to.u, n)).set(P::v, v_.place(context, to.v, n));
    // Without instances nothing is written there.
    pack_.set(P::instance, placed_ ? instance_.place(context, to.instance, n) : instances_.buffer());
    pack_.launch(queue_, n_rays_, target_.work_group);
    t_.take(queue_, to.t, n);
    primitive_.take(queue_, to.primitive, n);
    u_.take(queue_, to.u, n);
    v_.take(queue_, to.v, n);
    if (placed_) instance_.take(queue_, to.instance, n);
    queue_.finish();  // the arrays may go
    pack_.forget_launches();
  });
}

}  // namespace kdray::query
