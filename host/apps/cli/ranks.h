// What    kdray as one of several ranks, which mpirun or srun has started: how the run begins and ends, and
//         the options of the command line that concern it.
// Shape   Only render has ranks; other commands work alone in each process. Only rank 0 writes messages and
//         files. Another rank that fails tells rank 0 why, which says so with the rank's number and ends all.
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

// Runs `run` alone or as a rank, whichever this process is. Returns the exit code.
int run_in_ranks(const std::vector<std::string>& arguments, const std::function<int()>& run);

// Returns the ranks of this run; null: this process works alone.
const std::shared_ptr<transport::Ranks>& ranks_of_this_run();
// Returns the steps that the ranks of this run take together. There have to be ranks.
std::shared_ptr<transport::Together> together_of_this_run();
bool leads();  // alone, or rank 0

// --mpi, --hold
void add_ranks_options(CLI::App& app, Holding& holding);

void check_ranks(const RenderArgs& o);

// Returns whether each rank of this run holds a share of the scene, as ODPRT allows, and none the whole. Says
// so where ODPRT is wanted, but other options need the whole scene. All ranks call it.
bool holds_shares(const RenderArgs& o);

// Returns those faults of "1/0@3,0@5" that concern this rank: those for one rank alone (1), and those for
// all.
std::string faults_of_rank(const std::string& faults, int rank);

}  // namespace kdray::cli
