// What    Calls of kdray beside Python's other threads: without the GIL, ended by Ctrl-C, and not outlived by
//         the interpreter.
// Shape   Python's own handler only notes a signal; what it does is done by the main thread when it next
//         asks.
// Why     A thread that asks for the GIL while the interpreter ends is unwound by Python (before 3.14), which
//         C++ answers by ending the process; and what a call still uses may be gone by then. So the
//         interpreter's end (atexit) cancels the calls of other threads, which only daemons are then, waits
//         for them, and lets no new ones begin: such a thread ends by SystemExit, of which Python says
//         nothing.
// Forks   A child has none of the calls that other threads are in.
#pragma once

#include <nanobind/nanobind.h>

#include "kdray/cancel.h"

namespace kdray::python {

// As nanobind's gil_scoped_release. Throws ErrorCode::cancelled where the interpreter leaves this thread.
class WithoutGil {
 public:
  WithoutGil();
  ~WithoutGil();
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

 private:
  PyThreadState* state_;
};
using Released = nanobind::call_guard<WithoutGil>;

// Whether the interpreter is ending, by another thread than this.
bool is_left_by_interpreter();

// For a call that has let go of the GIL. A call that was cancelled leaves Python's exception set, or is left
// by the interpreter.
Cancel cancel_on_signals();

void add_interrupts(nanobind::module_& module);

}  // namespace kdray::python
