// What    Ctrl-C while kdray works: it asks Python for signals now and then.
// Shape   Python's own handler only notes a signal; what it does is done by the main thread when it next asks.
#pragma once

#include "kdray/cancel.h"

namespace kdray::python {

// For a call that has let go of the GIL. A cancelled call leaves Python's exception set.
Cancel cancel_on_signals();

}  // namespace kdray::python
