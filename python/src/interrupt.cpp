#include "interrupt.h"

#include <nanobind/nanobind.h>

#include <chrono>

namespace kdray::python {

Cancel cancel_on_signals() {
  using Clock = std::chrono::steady_clock;
  static constexpr auto kPause =
      std::chrono::milliseconds(20);  // taking the GIL may mean waiting for other threads
  return Cancel([next = Clock::now() + kPause]() mutable {
    if (Clock::now() < next) return false;
    const nanobind::gil_scoped_acquire gil;
    const bool interrupted = PyErr_CheckSignals() != 0;
    next = Clock::now() + kPause;
    return interrupted;
  });
}

}  // namespace kdray::python
