// What    `kdray bench modes --ranks`: of one process, or of several that mpirun has started.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "bench/modes/bench.h"

namespace kdray::cli {

struct RanksCommand {
  int samples = 1;
  double delay_ms = 2.5;
};

void add_ranks(CLI::App& app, bool& ranks, RanksCommand& command);

// The other options are those of `bench modes`.
int run_ranks_bench(const RanksCommand& command, const bench::ModesOptions& options,
                    const std::string& report);

}  // namespace kdray::cli
