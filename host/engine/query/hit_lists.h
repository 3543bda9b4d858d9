// What    Lists of hits on the device: one for each ray of a launch, sorted, of bounded size.
// Shape   find() fills them; pack() then moves them together into arrays of the host's.
// Errors  ErrorCode::internal where a walk failed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "device/opencl/spare_queue.h"
#include "engine/query/device_array.h"
#include "engine/query/near_rays.h"
#include "engine/query/target.h"
#include "engine/wavefront/stage.h"
#include "kdray/options.h"
#include "kdray/ray.h"
#include "layout/rays.layout.h"

namespace kdray::query {

// Where packed hits go: arrays that have space for them.
struct HitArrays {
  float* t;
  std::uint32_t* primitive;
  float *u, *v;
  std::uint32_t* instance;  // by index, or kNoInstance; null where the scene has none
};

// Whether the filter of a scene of doubles can't tell what the ray crosses: KDRAY_SPAN_IN_DOUBT of
// hit_list.clh.
inline bool is_in_doubt(const layout::QuerySpan& span) {
  return span.n_hits == 0 && span.more == 0 && span.last_number == 0xfffffffeu;
}

class HitLists {
 public:
  struct Walk {
    Traversal traversal;
    bool masked;  // rays and primitives have masks
  };
  struct RaysGiven {
    std::span<const Ray> rays;
    std::span<const std::uint32_t> masks;  // of each; none: all bits
  };

  // `space`: that rays are given in.
  HitLists(const Target& target, const Walk& walk, const LocalSpace& space);
  HitLists(const HitLists&) = delete;
  HitLists& operator=(const HitLists&) = delete;

  // Makes space for so many rays at a time, and for so many hits of all of them. It never gets less.
  void reserve(std::size_t rays, std::size_t hits);

  // Waits for what may still be running; whether it can be used again.
  bool settle() noexcept { return clFinish(queue_()) == CL_SUCCESS; }

  // The first `capacity` hits of each ray; behind `after`, the ray's span of before, where that isn't empty.
  // `any_length`: directions may be of a length that is_ordinary() doesn't allow. What is returned is valid
  // until the next call, and the rays have to stay as long.
  std::span<const layout::QuerySpan> find(const RaysGiven& given, bool any_length,
                                          std::span<const layout::QuerySpan> after, std::uint32_t capacity);

  // The hits of ray i that were found last to places[i] and behind, `n` places in all. Primitives are named
  // by their numbers, or with `as_refs` by reference.
  void pack(std::span<const std::uint32_t> places, std::size_t n, bool as_refs, const HitArrays& to);

 private:
  // An array of the caller's, for kernels to read: a small one is copied to memory that is kept, a large one
  // taken as it lies.
  template <class T>
  struct Given {
    DeviceArray<T> kept;
    cl::Buffer large;
    const cl::Buffer& take(const Target& target, cl::CommandQueue& queue, std::span<const T> values,
                           const char* what);
  };
  void pack_here(std::span<const std::uint32_t> places, bool as_refs, const HitArrays& to);

  // Packed hits on their way to the caller's memory: the same.
  template <class T>
  struct Taken {
    DeviceArray<T> kept;
    cl::Buffer large;
    bool lent = false;
    const cl::Buffer& place(const device::Context& context, T* to, std::size_t n);
    void take(cl::CommandQueue& queue, T* to, std::size_t n);
  };

  const Target& target_;
  bool chunked_;
  wavefront::Stage<kernels::CollectHits> collect_;
  wavefront::Stage<kernels::PackHits> pack_;
  bool masked_, placed_;  // primitives have masks; there are instances
  device::SpareQueue spare_;
  cl::CommandQueue queue_;
  float scale_;                          // of the space that rays are given in
  std::vector<std::uint32_t> all_bits_;  // for rays that have no masks, among primitives that do
  Given<Ray> rays_;
  Given<std::uint32_t> masks_, places_;
  Given<layout::QuerySpan> after_;
  DeviceArray<layout::QuerySpan> spans_;
  DeviceArray<layout::QueryHit> hits_;
  DeviceArray<std::uint32_t> instances_;  // of the hits
  Taken<float> t_, u_, v_;
  Taken<std::uint32_t> primitive_, instance_;
  std::span<const Ray> given_;
  std::size_t n_rays_ = 0;
  std::uint32_t capacity_ = 0;
  bool any_length_ = false;
};

}  // namespace kdray::query
