// What    The commands of `kdray bench`: apps/cli/command.h says what a command is.
#pragma once

#include "apps/cli/command.h"

namespace kdray::cli {

Command add_bench_rays(CLI::App& bench);
Command add_bench_queries(CLI::App& bench);
Command add_bench_frames(CLI::App& bench);
Command add_bench_build(CLI::App& bench);
Command add_bench_depth(CLI::App& bench);
Command add_bench_modes(CLI::App& bench);
Command add_bench_accuracy(CLI::App& bench);
Command add_bench_ablation(CLI::App& bench);
Command add_bench_instances(CLI::App& bench);

}  // namespace kdray::cli
