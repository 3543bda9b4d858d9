// What    The part of `kdray bench` that takes away what saves work.
#pragma once

#include "cli/command.h"

namespace kdray::cli {

Command add_bench_ablation(CLI::App& bench);

}  // namespace kdray::cli
