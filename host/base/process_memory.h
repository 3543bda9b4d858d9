// What    How much more memory this process may take, and the largest resident set that it had while
//         something ran.
// Shape   What is free is what the machine has free or what is left of the limits that the process runs under
//         (ulimit -v, the memory controllers of its control groups), whichever is least.
// Why     A process that goes beyond the limit of its control group is killed without a message.
// Units   bytes.
// Source  proc(5), cgroups(7); Documentation/admin-guide/cgroup-v2.rst and cgroup-v1/memory.rst of Linux.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

namespace kdray {

// The folders in which the system describes itself; tests make their own.
struct SystemFiles {
  std::filesystem::path proc = "/proc";
  std::filesystem::path cgroup = "/sys/fs/cgroup";
};

// Returns the largest number where nothing is known.
std::uint64_t free_memory(const SystemFiles& files = {});

// Returns what `work` needs beyond what the process holds when it begins. The system then counts the process'
// peak anew, for getrusage and VmHWM too.
std::optional<std::uint64_t> peak_bytes_of(const std::function<void()>& work);

// Gives back to the system what malloc keeps for later, as far as it is whole pages.
void give_back_free_memory();

// Returns the peak since the process began, or since peak_bytes_of() was last called.
std::optional<std::uint64_t> peak_bytes();

}  // namespace kdray
