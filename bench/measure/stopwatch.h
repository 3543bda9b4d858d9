// What    A stopwatch for wall time and for the processor's time of all of the process' threads, which tells
//         more where others are at work. Units: seconds since it was made.
#pragma once

#include <ctime>

#include "base/timer.h"

namespace kdray::bench {

class Stopwatch {
 public:
  double wall() const { return timer_.seconds(); }
  double cpu() const { return processor() - cpu_; }

 private:
  static double processor() {
    timespec t{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }

  Timer timer_;
  double cpu_ = processor();
};

}  // namespace kdray::bench
