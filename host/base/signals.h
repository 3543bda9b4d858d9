// What    Signals that end the program: what is temporary is removed, then the program dies of the signal as
//         any other does, so that a shell sees what ended it.
// Why     No signal handler: LLVM, inside PoCL, sets its own as soon as it compiles something, which swallow
//         SIGQUIT. Signals are blocked in every thread, and one thread waits for them; it may do what a
//         handler may not.
#pragma once

namespace kdray {

// Blocks the signals and starts the thread that waits for them. The first thread calls this before there are
// others, which inherit what it blocks. Child processes inherit it too, and must be started with an empty
// mask (POSIX_SPAWN_SETSIGMASK).
void mind_signals();

// Unblocks the signals, for a program that is about to take this one's place (exec) and would inherit the
// block.
void leave_signals_alone();

}  // namespace kdray
