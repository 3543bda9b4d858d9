// What    Ranks that an MPI has started, reached through the plugin libkdray-mpi.so (mpi_plugin/), so that
//         kdray itself is not linked with any MPI.
// Shape   The plugin is looked for where KDRAY_MPI_PLUGIN says, else beside the program: in ../lib of its
//         folder, in ../lib/kdray, and where the system's loader looks.
// Errors  ErrorCode::usage, in one line, when there is no plugin, when it is of another version, or when its
//         MPI is not the one that has started this process.
#pragma once

#include <memory>

#include "cluster/transport/transport.h"

namespace kdray::transport {

// `expected`: how many ranks the launcher has started; 0: it doesn't say.
std::unique_ptr<Transport> open_mpi(int expected);

}  // namespace kdray::transport
