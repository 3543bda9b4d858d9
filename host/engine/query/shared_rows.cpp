#include "engine/query/shared_rows.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.h"

namespace kdray::query {

RowRange SharedRows::take(std::size_t most) {
  const std::lock_guard lock(mutex_);
  if (stopped_) return {n_, 0};
  const std::size_t first = next_;
  next_ += std::min(most, n_ - first);
  return {first, next_ - first};
}

bool SharedRows::wait_for_turn(std::size_t first) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return stopped_ || n_together_ == first; });
  return n_together_ == first;
}

void SharedRows::put_together(std::size_t n) {
  const std::lock_guard lock(mutex_);
  n_together_ += n;
  changed_.notify_all();
}

void SharedRows::fail(std::size_t first, std::exception_ptr error) {
  const std::lock_guard lock(mutex_);
  if (!error_ || first < first_failed_) {
    first_failed_ = first;
    error_ = std::move(error);
  }
  stopped_ = true;
  changed_.notify_all();
}

void SharedRows::stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  changed_.notify_all();
}

void SharedRows::rethrow() const {
  if (error_) std::rethrow_exception(error_);
}

namespace {

// A query's threads, one for each place, and the caller's, which waits for them.
class PlaceThreads {
 public:
  PlaceThreads(const QueryContext& context, SharedRows& rows, const PlaceWork& work)
      : rows_(rows), n_working_(context.places.size()) {
    threads_.reserve(n_working_);
    for (Place& place : context.places)
      threads_.emplace_back([this, &place, &work, n = context.places.size()] { run(place, n, work); });
  }

  QueryReport wait(const std::optional<Cancel>& cancel) {
    constexpr auto kLook = std::chrono::milliseconds(5);
    bool cancelled = false;
    std::unique_lock lock(mutex_);
    for (; n_working_ > 0; done_.wait_for(lock, kLook)) {
      if (cancelled || !cancel || !cancel->is_cancelled()) continue;
      cancelled = true;
      cancel_.cancel();
      rows_.stop();
    }
    threads_.clear();
    if (cancelled) throw_if_cancelled(cancel_);
    rows_.rethrow();
    return {n_invalid_};
  }

 private:
  void run(Place& place, std::size_t n_places, const PlaceWork& work) {
    RowTaker taker(rows_, n_places);
    std::uint64_t n_invalid = 0;
    try {
      n_invalid = work(place, taker, cancel_).invalid;
    } catch (...) {
      rows_.fail(taker.last(), std::current_exception());
    }
    const std::lock_guard lock(mutex_);
    n_invalid_ += n_invalid;
    --n_working_;
    done_.notify_one();
  }

  SharedRows& rows_;
  Cancel cancel_;  // of the threads, which may not ask the caller's
  std::mutex mutex_;
  std::condition_variable done_;
  std::size_t n_working_;
  std::uint64_t n_invalid_ = 0;
  std::vector<std::jthread> threads_;
};

}  // namespace

void throw_if_cancelled(const std::optional<Cancel>& cancel) {
  if (cancel && cancel->is_cancelled()) throw Error(ErrorCode::cancelled, "the query was cancelled");
}

QueryReport share_rows(const QueryContext& context, std::size_t n, std::size_t few,
                       const std::optional<Cancel>& cancel, const PlaceWork& work) {
  throw_if_cancelled(cancel);
  SharedRows rows(n);
  if (context.places.size() > 1 && n > few) return PlaceThreads(context, rows, work).wait(cancel);
  RowTaker taker(rows, 1);
  return work(context.places.front(), taker, cancel);
}

}  // namespace kdray::query
