// What    Whether this process is one of several that mpirun or srun has started, told before any MPI is
//         opened.
#pragma once

#include <string>

namespace kdray::transport {

struct Launched {
  int ranks = 0;        // 0: by no launcher of ranks
  int rank = 0;         // as far as the launcher tells
  std::string by = {};  // "mpirun", "srun"
};

Launched launched();

}  // namespace kdray::transport
