// What    Kernels with their queue and buffers, ready to trace a chunk of rays: what one call of a query
//         needs for itself, kept for the next one.
// Shape   A Session serves one call at a time, from any thread; Sessions makes as many as there are calls at
//         once. Chunks are so small that rays and hits stay in a cache between host and kernel, and so large
//         that a launch is of no account; a GPU's are larger.
// Why     Small batches: making a kernel, its buffers and its first launch takes a hundred times what one ray
//         takes.
// Errors  ErrorCode::internal for a ray whose walk failed; device errors as everywhere.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "base/array.h"
#include "device/spare_queue.h"
#include "layout/rays.layout.h"
#include "query/target.h"
#include "wavefront/stage.h"

namespace kdray::query {

// A hit's primitive where the walk failed: KDRAY_QUERY_INVALID of query.clh.
inline constexpr std::int32_t kFailedWalk = -2;

class Session {
 public:
  explicit Session(const Target& target);

  bool is_sound() const { return sound_; }  // the last launch has ended as it should
  std::size_t chunk() const { return rays_.size(); }

  // Where the rays of a chunk, in the scene's own space, and their masks are to be put.
  layout::QueryRay* rays() { return rays_.data(); }
  std::uint32_t* ray_masks() { return masks_.data(); }

  // Traces the first n. Of a hit `primitive` is its number, or with `as_refs` its reference (tree.layout.h);
  // t is in the scene's own space. Valid until the next call.
  std::span<const layout::QueryHit> trace(std::size_t n, bool any_hit, bool as_refs);

 private:
  void launch(std::size_t n);
  template <class T>
  cl::Buffer buffer_of(Array<T>& array, cl_mem_flags flags, const char* what);

  const device::Context* context_;
  bool sound_ = true;
  bool masked_;  // primitives have masks
  device::SpareQueue queue_;
  wavefront::Stage<kernels::TraceQuery> stage_;
  std::size_t work_group_;
  bool chunked_, in_place_;
  Array<layout::QueryRay> rays_;
  Array<layout::QueryHit> hits_;
  Array<std::uint32_t> masks_;
  cl::Buffer ray_buffer_, hit_buffer_, mask_buffer_;
};

class Sessions {
 public:
  explicit Sessions(const Target& target) : target_(target) {}

  // A session, given back when the pointer goes.
  class Give;
  using Borrowed = std::unique_ptr<Session, Give>;
  Borrowed borrow();

  class Give {
   public:
    explicit Give(Sessions* to = nullptr) : to_(to) {}
    void operator()(Session* session) const { to_->take_back(std::unique_ptr<Session>(session)); }

   private:
    Sessions* to_;
  };

 private:
  void take_back(std::unique_ptr<Session> session);

  Target target_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Session>> free_;
};

}  // namespace kdray::query
