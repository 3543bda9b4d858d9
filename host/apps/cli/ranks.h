// What    kdray as one of several ranks, which mpirun or srun has started: the way in and out of the run that
//         they are, and what of the command line goes with it.
// Shape   Only render has ranks; other commands work alone in each process. Of the ranks only rank 0 speaks,
//         and writes files: what another one has failed of, it tells rank 0, which says so with the rank's
//         number and ends all.
// Errors  kdray::Error, ErrorCode::usage: options that don't go together with ranks.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/cli/render_frame.h"
#include "cluster/transport/ranks.h"
#include "cluster/transport/together.h"

namespace kdray::cli {

// Runs it as what this process is: alone, or as a rank. Returns the exit code.
int run_in_ranks(const std::vector<std::string>& arguments, const std::function<int()>& run);

// Of this run; null: this process works alone.
const std::shared_ptr<transport::Ranks>& ranks_of_this_run();
// The steps that its ranks take together; there have to be some.
std::shared_ptr<transport::Together> together_of_this_run();
bool leads();  // alone, or rank 0

// --mpi, --hold
void add_ranks_options(CLI::App& app, std::string& hold);

void check_ranks(const RenderArgs& o);

// "1/0@3,0@5": what is for one rank alone (1), and what is for all.
std::string faults_of_rank(const std::string& faults, int rank);

}  // namespace kdray::cli
