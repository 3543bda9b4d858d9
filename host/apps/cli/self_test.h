// What    A scene with answers known in closed form, traced and rendered on a device: does it compute
//         rightly? And `kdray --try`, the child of a trial (probe/trial/trial.h), which may be asked for
//         just that. It is no command: kdray starts it itself.
#pragma once

#include <string>

namespace kdray::cli {

// Returns what is wrong, in one line; empty: nothing.
std::string self_test(const std::string& device);

// Does the trial that the arguments ask for and ends the process; returns where they ask for none.
void try_if_asked(int argc, char** argv);

}  // namespace kdray::cli
