// What    Lists of hits on the device: one for each ray of a launch, sorted, of bounded size.
// Shape   find() fills them; pack() then moves them together into arrays of the host's.
// Errors  ErrorCode::internal where a walk failed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "device/spare_queue.h"
#include "kdray/options.h"
#include "kdray/ray.h"
#include "layout/rays.layout.h"
#include "query/near_rays.h"
#include "query/target.h"
#include "wavefront/stage.h"

namespace kdray::query {

// Where packed hits go: arrays that have room for them.
struct HitArrays {
  float* t;
  std::uint32_t* primitive;
  float *u, *v;
};

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

  // Room for so many rays at a time, and for so many hits of all of them.
  HitLists(const Target& target, const Walk& walk, const LocalSpace& space, std::size_t rays,
           std::size_t hits);
  ~HitLists() { unmap(); }
  HitLists(const HitLists&) = delete;
  HitLists& operator=(const HitLists&) = delete;

  std::size_t most_hits() const { return most_hits_; }

  // The first `capacity` hits of each ray; behind `after`, the ray's span of before, where that isn't empty.
  // `any_length`: directions may be of a length that is_ordinary() doesn't allow. What is returned is valid
  // until the next call, and the rays have to stay as long.
  std::span<const layout::QuerySpan> find(const RaysGiven& given, bool any_length,
                                          std::span<const layout::QuerySpan> after, std::uint32_t capacity);

  // The hits of ray i that were found last to places[i] and behind, `n` places in all.
  void pack(std::span<const std::uint32_t> places, std::size_t n, const HitArrays& to);

 private:
  void unmap() noexcept;

  const Target& target_;
  std::size_t most_hits_;
  bool chunked_;
  wavefront::Stage<kernels::CollectHits> collect_;
  wavefront::Stage<kernels::PackHits> pack_;
  bool masked_;
  device::SpareQueue spare_;
  cl::CommandQueue queue_;
  std::vector<std::uint32_t> all_bits_;  // for rays that have no masks, among primitives that do
  cl::Buffer rays_, masks_, after_, spans_, hits_;
  std::size_t n_rays_ = 0;
  std::uint32_t capacity_ = 0;
  bool any_length_ = false;
  void* found_ = nullptr;  // spans_, mapped
};

}  // namespace kdray::query
