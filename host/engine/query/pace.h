// What    How many elements a query takes next: as many as took a quarter of a second by the last ones' time,
//         beginning with few, so that a call in any scene looks for cancellation soon.
// Why     A ray may cross a hundred thousand triangles, and a point be as far from all of them: so what
//         bounds a launch is its time, not its size. What is answered doesn't depend on it.
#pragma once

#include <algorithm>
#include <cstddef>

#include "base/timer.h"

namespace kdray::query {

class Pace {
 public:
  Pace(std::size_t first, std::size_t most) : next_(first), most_(most) {}

  // Elements to take now, whose time counts from here.
  std::size_t take() {
    timer_ = Timer();
    return next_;
  }

  // So many have been done; no more than `fit` are to be taken next.
  void done(std::size_t n, std::size_t fit) {
    constexpr double kAimed = 0.25;
    const double in_time = kAimed / std::max(timer_.seconds(), 1e-6) * static_cast<double>(n);
    next_ = std::min({static_cast<std::size_t>(std::min(in_time, 1e9)), fit, 64 * n, most_});
    next_ = std::max<std::size_t>(next_, 1);
  }
  void done(std::size_t n) { done(n, most_); }

 private:
  std::size_t next_, most_;
  Timer timer_;
};

}  // namespace kdray::query
