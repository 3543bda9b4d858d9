// What    The rays or points of one call, which all places share: each takes the next rows when it has none
//         left, as many as take a quarter of a second. A small call goes to the first place alone.
// Errors  Of several places' errors the one of the first rows is thrown, whichever came first; then nobody
//         takes further rows. A cancelled call throws ErrorCode::cancelled.
// Threads With several places each has a thread of its own, and the caller's looks for cancellation.
// Why     A ray may cross a hundred thousand triangles, and a point be as far from all of them: so what
//         bounds a launch is its time, not its size. What is answered doesn't depend on it.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>

#include "base/timer.h"
#include "engine/query/queries.h"
#include "kdray/cancel.h"
#include "kdray/query.h"

namespace kdray::query {

// Throws for a call that has been cancelled. The thread that made the call may ask, and no other.
void throw_if_cancelled(const std::optional<Cancel>& cancel);

// Calls work(first, last) for parts of [0, n), from several threads of the host, where an element may take
// long; looks for cancellation now and then. Each part but the last has kSlowGrain elements.
inline constexpr std::size_t kSlowGrain = 64;
template <class Work>
void for_each_slow_grain(std::size_t n, const std::optional<Cancel>& cancel, const Work& work) {
  constexpr std::size_t kGrain = kSlowGrain, kLook = 64 * kGrain;
  for (std::size_t first = 0; first < n; first += kLook) {
    throw_if_cancelled(cancel);
    const std::size_t last = std::min(n, first + kLook);
    tbb::parallel_for(std::size_t{0}, (last - first + kGrain - 1) / kGrain, [&](std::size_t grain) {
      work(first + grain * kGrain, std::min(last, first + (grain + 1) * kGrain));
    });
  }
}

class Pace {
 public:
  // `kept`: what was learned, for the next call; 0: nothing yet.
  Pace(std::size_t first, std::size_t most, std::atomic<std::size_t>& kept)
      : next_(kept > 0 ? kept.load() : first), most_(most), kept_(kept) {}

  // Elements to take now, whose time counts from here.
  std::size_t take() {
    timer_ = Timer();
    return next_;
  }

  // So many have been done; no more than `fit` are to be taken next.
  void done(std::size_t n, std::size_t fit) {
    constexpr double kAimed = 0.25;
    const double in_time = kAimed / std::max(timer_.seconds(), 1e-6) * static_cast<double>(n);
    const std::size_t possible =
        std::max<std::size_t>(std::min({static_cast<std::size_t>(std::min(in_time, 1e9)), fit, most_}), 1);
    const bool as_many_as_taken = n >= next_;  // a call's last ones tell only when they were slow
    next_ = std::min(possible, 64 * n);
    if (as_many_as_taken || possible < kept_) kept_ = as_many_as_taken ? next_ : possible;
  }
  void done(std::size_t n) { done(n, most_); }

 private:
  std::size_t next_, most_;
  std::atomic<std::size_t>& kept_;
  Timer timer_;
};

struct RowRange {
  std::size_t first, n;  // n is 0: none are left
};

class SharedRows {
 public:
  explicit SharedRows(std::size_t n) : n_(n) {}

  std::size_t size() const { return n_; }

  // At most so many; they are handed out in ascending order.
  RowRange take(std::size_t most);

  // For answers that have to be put together in the rows' order: waits until those of all rows before `first`
  // have been. False where another place has failed, so that they never will be.
  bool wait_for_turn(std::size_t first);
  void put_together(std::size_t n);

  // Notes that a place has failed, which had last taken these rows.
  void fail(std::size_t first, std::exception_ptr error);
  void stop();
  void rethrow() const;  // if anyone has failed

 private:
  const std::size_t n_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t next_ = 0, n_together_ = 0;
  bool stopped_ = false;
  std::size_t first_failed_ = 0;
  std::exception_ptr error_;
};

// What one place takes of them.
class RowTaker {
 public:
  RowTaker(SharedRows& rows, std::size_t n_places) : rows_(rows), n_places_(n_places) {}

  RowRange take(std::size_t most) {
    const RowRange taken = rows_.take(most);
    if (taken.n > 0) last_ = taken.first;
    return taken;
  }
  std::size_t last() const { return last_; }
  // How many rows each place has to do, about.
  std::size_t fair_share() const { return rows_.size() / n_places_; }
  SharedRows& all() const { return rows_; }

 private:
  SharedRows& rows_;
  std::size_t n_places_;
  std::size_t last_ = 0;
};

// What one place does: takes rows until none are left, and looks for cancellation in between.
using PlaceWork =
    std::function<QueryReport(Place& place, RowTaker& rows, const std::optional<Cancel>& cancel)>;

// Has all places work at n rows; `few` and fewer go to the first one alone. Returns their reports' sum.
QueryReport share_rows(const QueryContext& context, std::size_t n, std::size_t few,
                       const std::optional<Cancel>& cancel, const PlaceWork& work);

}  // namespace kdray::query
