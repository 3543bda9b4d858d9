// What    The largest resident set of this process while something runs, where the system lets it be measured
//         (Linux).
// Units   bytes.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

namespace kdray {

// What `work` needs beyond what the process holds when it begins. The system then counts the process' peak
// anew: getrusage and VmHWM no longer know of earlier ones.
std::optional<std::uint64_t> peak_bytes_of(const std::function<void()>& work);

// To the system, as far as it is whole pages: what malloc keeps for later.
void give_back_free_memory();

// Since the process began, or was last asked about some work.
std::optional<std::uint64_t> peak_bytes();

}  // namespace kdray
