// What    `kdray --try`: the child of a trial (trial/request.h). It is no command: kdray starts it itself.
#pragma once

namespace kdray::cli {

// Does the trial that the arguments ask for, and ends the process; returns where they ask for none.
void try_if_asked(int argc, char** argv);

}  // namespace kdray::cli
