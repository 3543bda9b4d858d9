// What    Ranks that an MPI has started, reached through the plugin libkdray-mpi.so (mpi_plugin/), so that
//         kdray itself is not linked with any MPI.
// Shape   The plugin is looked for where KDRAY_MPI_PLUGIN says, else beside the program: in ../lib of its
//         folder, in ../lib/kdray, and where the system's loader looks.
// Errors  ErrorCode::usage, in one line, when there is no plugin, when it is of another version, or when its
//         MPI is not the one that has started this process.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cluster/transport/ranks.h"
#include "cluster/transport/transport.h"

namespace kdray::transport {

// What a launcher (mpirun, srun) has made of this process: whether it is one of several ranks, told before
// any MPI is opened; and the cores that it shares with other ranks on its machine, dealt out so that
// together they have as many threads as there are cores. Ranks that may run on the same cores of one
// machine share them equally, each on some of its own where there are enough; a rank that is alone on its
// cores keeps them all. What the launcher has bound a rank to stays its own. Threads of the host follow by
// themselves; PoCL, which counts the machine's cores, is told by a variable of its own, unless the user has
// set it. Threads: share_cores() comes before any thread that is to work, and before OpenCL's first call.
struct Launched {
  int ranks = 0;        // 0: no launcher of ranks has started this process
  int rank = 0;         // as far as the launcher tells
  std::string by = {};  // "mpirun", "srun"
};

// Returns what the launcher's variables tell.
Launched launched();

// Binds this rank to its share of the cores. All ranks call it.
void share_cores(Ranks& ranks);

// Returns which of these cores the `index`-th of `n` ranks gets that may run on all of them: at least one,
// and the others' as well where there are too few.
std::vector<int> cores_of(const std::vector<int>& cores, std::size_t index, std::size_t n);

// Opens the transport. `expected`: how many ranks the launcher has started; 0: it doesn't say.
std::unique_ptr<Transport> open_mpi(int expected);

}  // namespace kdray::transport
