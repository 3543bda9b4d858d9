// What    The parts of `kdray bench` that are about trees.
#pragma once

#include "cli/command.h"

namespace kdray::cli {

Command add_bench_build(CLI::App& bench);
Command add_bench_depth(CLI::App& bench);

}  // namespace kdray::cli
