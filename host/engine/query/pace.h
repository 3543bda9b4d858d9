// What    How many elements a query takes next: as many as took a quarter of a second by the last ones' time,
//         of this call or of the one before about the same scene. The first call begins with few, so that it
//         looks for cancellation soon in any scene.
// Why     A ray may cross a hundred thousand triangles, and a point be as far from all of them: so what
//         bounds a launch is its time, not its size. What is answered doesn't depend on it.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>

#include "base/timer.h"

namespace kdray::query {

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

}  // namespace kdray::query
