// What    The passes in which all hits of rays are found, chunk by chunk: a first one with short lists, which
//         are enough for nearly all rays, and further ones for the rays that have more.
// Shape   begin() a call; for each chunk trace_first_pass(), then trace_further_passes(), and pack() of
//         first_lists() for the hits of the first pass. Kernels and buffers serve the next call too
//         (queries.h).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "base/memory.h"
#include "engine/query/all_hits.h"
#include "engine/query/check_rays.h"
#include "engine/query/hit_lists.h"
#include "engine/query/near_rays.h"
#include "kdray/options.h"

namespace kdray::query {

// Hits by themselves, as structures of arrays.
struct Hits {
  RawVector<float> t, u, v;
  RawVector<std::uint32_t> primitive, instance;

  Hits() = default;
  Hits(std::size_t n, bool placed) : t(n), u(n), v(n), primitive(n), instance(placed ? n : 0) {}
  std::size_t size() const { return t.size(); }
  HitArrays arrays() {
    return {t.data(), primitive.data(), u.data(), v.data(), instance.empty() ? nullptr : instance.data()};
  }

  // The hits [first, first + n) to place `at` and behind.
  void copy(std::size_t first, std::size_t n, const HitArrays& to, std::size_t at) const;
};

class Passes {
 public:
  explicit Passes(const Target& target) : Passes(target, target.traversal) {}
  Passes(const Target& target, Traversal traversal);
  bool settle() noexcept;

  // A call about so many rays. (Its traversal has been chosen.)
  void begin(std::size_t n_rays, const CollectOptions& options);

  // How many of the rays that are left the next chunk has.
  std::size_t next_chunk(std::size_t left) const;
  HitLists& first_lists() { return first_; }
  const Target& target() const { return target_; }
  bool has_instances() const { return !target_.scene.flat.instances.empty(); }
  const NearRays& near_rays() const { return near_rays_; }  // of the chunk in work
  // Rays of the chunk for which is_in_doubt() held in a pass.
  std::span<const std::uint32_t> in_doubt() const { return in_doubt_; }

  // The first pass of the next chunk: what it found of each ray. (Looked at just before they are traced, the
  // rays come from memory once.)
  std::span<const layout::QuerySpan> trace_first_pass(std::span<const Ray> rays,
                                                      std::span<const std::uint32_t> masks);

  // More hits of ray `ray` of the chunk, in their order, and whether it has others.
  struct More {
    std::uint32_t ray;
    const Hits* hits;  // [first, first + n) of these, unless null: they aren't wanted
    std::size_t first;
    std::uint32_t n;
    bool others;
  };
  using Found = std::function<bool(const More&)>;  // whether to go on

  // Finds all that the chunk's rays have beyond the first pass, but no more than max_hits of a ray. `spans`
  // is what trace_first_pass() returned. Hits are valid until the next call. Whether it went on to the end.
  bool trace_further_passes(std::span<const layout::QuerySpan> spans, bool want_hits, const Found& found);

 private:
  struct Rest {
    std::uint32_t ray, n_hits;
    layout::QuerySpan span;
  };
  bool pass(std::span<const Rest> rest, bool want_hits, const Found& found, std::vector<Rest>& still);
  const Hits* packed(std::span<const layout::QuerySpan> spans);

  const Target& target_;
  Traversal traversal_;
  bool masked_;
  NearRays near_rays_;
  HitLists first_;
  std::unique_ptr<HitLists> later_;
  std::vector<std::unique_ptr<Hits>> later_hits_;  // of the chunk, a pass each
  // What the call asks for.
  bool faulty_miss_ = false, as_refs_ = false;
  std::optional<Cancel> cancel_;
  std::uint32_t max_hits_ = 0, capacity_ = 0;
  std::size_t launch_capacity_ = 0;  // for hits in a launch
  std::size_t n_taken_ = 0;          // rays of the chunks so far
  // Of the chunk in work: its rays, and what holds them where some are none.
  RaysSeen seen_{};
  std::span<const Ray> rays_;
  std::vector<Ray> kept_;
  std::span<const std::uint32_t> masks_;
  std::vector<std::uint32_t> in_doubt_;
};

}  // namespace kdray::query
