// What    kdray bench accuracy, as a command of bench's.
#pragma once

#include "cli/command.h"

namespace kdray::cli {

Command add_bench_accuracy(CLI::App& bench);

}  // namespace kdray::cli
