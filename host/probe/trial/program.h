// What    The program that a trial is made by: kdray itself, whose first argument is then "--try".
// Why     A program, and no fork() of this process: only its own copy of OpenCL's loader, with no thread that
//         a fork would have left behind and no lock that nobody gives back, shows what a driver does. Whoever
//         uses kdray as a library has another main(), which can't be asked.
#pragma once

#include <filesystem>
#include <optional>

namespace kdray::trial {

// To be called by a program that does trials itself when it is told so (request.h).
void this_program_tries();

// This program, if it does trials; else the one that KDRAY_PROGRAM names; else `kdray`: beside the running
// program, where it was installed, or in PATH. Empty where there is none.
std::optional<std::filesystem::path> program();

}  // namespace kdray::trial
