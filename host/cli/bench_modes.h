// What    kdray bench modes, as a command of bench's.
#pragma once

#include "cli/command.h"

namespace kdray::cli {

Command add_bench_modes(CLI::App& bench);

}  // namespace kdray::cli
