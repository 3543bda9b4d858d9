// What    The queries: a program's rays or points in, its arrays filled.
// Shape   Chunk by chunk, on all places at once (shared_rows.h): rays to the scene's own space
//         (local_rays.h), traced (trace.h, passes.h) or looked up (point_session.h), answers to the
//         caller's arrays.
// Errors  As kdray/query.h says. What was written before an error is left.
// Threads As many calls at once as there are threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "accel/prepare/prepared.h"
#include "engine/query/geometry_table.h"
#include "engine/query/local_rays.h"
#include "engine/query/passes.h"
#include "engine/query/point_session.h"
#include "engine/query/target.h"
#include "engine/query/trace.h"
#include "kdray/query.h"

namespace kdray::query {

// What every query needs: a scene that is ready, on the queues that answer, and what its numbers mean; and
// kernels with their queues and buffers, kept from one call for the next. A place is what works by itself:
// a device, or each of the equal parts that it is divided into. A session is whatever is made of a Target
// and has settle(), which waits for what may still be running on it, and says whether it can serve again.
// It serves one call at a time, from any thread. Why: Small batches: making a kernel, its buffers and its
// first launch takes a hundred times what one ray takes.
template <class Session>
class Sessions {
 public:
  // The target has to outlive it.
  explicit Sessions(const Target& target) : target_(&target) {}

  // A session, given back when the pointer goes.
  class Give {
   public:
    explicit Give(Sessions* to = nullptr) : to_(to) {}
    void operator()(Session* session) const { to_->take_back(std::unique_ptr<Session>(session)); }

   private:
    Sessions* to_;
  };
  using Borrowed = std::unique_ptr<Session, Give>;

  Borrowed borrow() {
    std::unique_ptr<Session> session;
    if (const std::lock_guard lock(mutex_); !free_.empty()) {
      session = std::move(free_.back());
      free_.pop_back();
    }
    if (!session) session = std::make_unique<Session>(*target_);  // which may compile: others go on
    return {session.release(), Give(this)};
  }

 private:
  void take_back(std::unique_ptr<Session> session) {
    if (!session->settle()) return;
    const std::lock_guard lock(mutex_);
    try {
      free_.push_back(std::move(session));
    } catch (const std::bad_alloc&) {  // the next one is made anew
    }
  }

  const Target* target_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Session>> free_;
};

struct AllSessions {
  explicit AllSessions(const Target& target)
      : unmasked(without_masks(target)), rays(target), crossings(target), of_all(unmasked), points(target) {}

  Target unmasked;
  Sessions<Session> rays;      // closest, any
  Sessions<Passes> crossings;  // count, all
  Sessions<Passes> of_all;     // of every geometry, whatever its mask: inside
  Sessions<PointSession> points;
  std::atomic<std::size_t> counted_at_once{0}, collected_at_once{0}, points_at_once{0};  // Pace
  std::atomic<std::size_t> asked_in_between{0};  // rays: see QueryContext::filters

 private:
  static Target without_masks(Target target) {
    target.masks = cl::Buffer();
    return target;
  }
};

struct Place {
  explicit Place(const Target& asked) : target(asked), sessions(target) {}

  const Target target;  // of rays in the scene's own space
  AllSessions sessions;
};

struct QueryContext {
  std::deque<Place>& places;  // one at least, of the same scene
  const GeometryTable& table;
  const LocalFrame& frame;

  const prepare::Prepared& scene() const { return places.front().target.scene; }
  bool has_masks() const { return places.front().target.masks() != nullptr; }
  // Of a scene of doubles: whether the devices are to look at so many rays first, that are asked now. Few are
  // the host's, and of calls in between the first ones, which take it less time than devices take to begin.
  bool filters(std::size_t n_rays) const {
    constexpr std::size_t kFew = std::size_t{1} << 10, kMany = std::size_t{1} << 14;
    if (n_rays < kFew || !std::ranges::all_of(places, [](const Place& p) { return p.target.filters; }))
      return false;
    return n_rays >= kMany || places.front().sessions.asked_in_between.fetch_add(n_rays) >= kMany;
  }
};

// What every query looks at on its way: ErrorCode::input for the first ray that means nothing, where such are
// errors, and for an array of answers of another size.
void check_invalid(const LocalRays& rays, InvalidRays invalid);
void check_out(std::size_t size, std::size_t n, const char* name);

// Closest and any hits (closest.cpp).
QueryReport closest(const QueryContext& context, const Rays& rays, const HitsOut& out,
                    const QueryOptions& options);

// Writes 1 for each ray that something lies in the way of, else 0.
QueryReport any(const QueryContext& context, const Rays& rays, const BytesOut& out,
                const QueryOptions& options);

// How many surfaces rays cross, and all of these crossings (crossings.cpp).
QueryReport count(const QueryContext& context, const Rays& rays, const WordsOut& out,
                  const QueryOptions& options);

AllHits all(const QueryContext& context, const Rays& rays, const AllHitsOptions& options);

// Of points (points.cpp).
QueryReport closest_points(const QueryContext& context, const Points& points, const ClosestPointsOut& out,
                           const PointOptions& options);

QueryReport inside(const QueryContext& context, const Points& points, const BytesOut& out,
                   const PointOptions& options);

QueryReport signed_distance(const QueryContext& context, const Points& points, const ValuesOut& out,
                            const PointOptions& options);

}  // namespace kdray::query
