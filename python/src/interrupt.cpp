#include "interrupt.h"

#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "kdray/error.h"

namespace kdray::python {

namespace {

namespace nb = nanobind;

std::atomic<int> calls{0};  // that are going on
std::atomic<bool> ending{false};
std::atomic<std::thread::id> ender;  // before `ending`

// What Python's atexit calls.
void end_calls() {
  ender = std::this_thread::get_id();
  ending = true;
  while (calls > 0) {
    {
      const nb::gil_scoped_release released;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
  }
}

// Python unwinds a thread that it leaves, by an exception that must not be kept: it is kept here for good.
void take_gil(PyThreadState* state) noexcept {
  try {
    PyEval_RestoreThread(state);
  } catch (...) {
    for (;;) ::pause();
  }
}

}  // namespace

WithoutGil::WithoutGil() {
  ++calls;
  if (is_left_by_interpreter()) {
    --calls;
    throw Error(ErrorCode::cancelled, "the interpreter is ending");
  }
  state_ = PyEval_SaveThread();
}

WithoutGil::~WithoutGil() {
  --calls;
  take_gil(state_);
}

bool is_left_by_interpreter() {
  return ending && ender.load() != std::this_thread::get_id();
}

Cancel cancel_on_signals() {
  using Clock = std::chrono::steady_clock;
  static constexpr auto kPause =
      std::chrono::milliseconds(20);  // taking the GIL may mean waiting for other threads
  return Cancel([next = Clock::now() + kPause]() mutable {
    if (is_left_by_interpreter()) return true;
    if (Clock::now() < next) return false;
    const nb::gil_scoped_acquire gil;
    const bool interrupted = PyErr_CheckSignals() != 0;
    next = Clock::now() + kPause;
    return interrupted;
  });
}

void add_interrupts(nb::module_& module) {
  ::pthread_atfork(nullptr, nullptr, [] { calls = 0; });
  module.def("end_calls", &end_calls);
  nb::module_::import_("atexit").attr("register")(module.attr("end_calls"));
}

}  // namespace kdray::python
