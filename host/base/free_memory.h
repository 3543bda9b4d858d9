// What    How much more memory this process may take: what the machine has free, and what is left of the
//         limits that it runs under (ulimit -v, the memory controllers of its control groups), whichever is
//         least.
// Why     Nobody is told of a control group's limit: beyond it the process is killed without a word.
// Units   bytes.
// Source  proc(5), cgroups(7); Documentation/admin-guide/cgroup-v2.rst and cgroup-v1/memory.rst of Linux.
#pragma once

#include <cstdint>
#include <filesystem>

namespace kdray {

// Where the system tells of itself; tests have files of their own.
struct SystemFiles {
  std::filesystem::path proc = "/proc";
  std::filesystem::path cgroup = "/sys/fs/cgroup";
};

// All there is where nothing is known.
std::uint64_t free_memory(const SystemFiles& files = {});

}  // namespace kdray
