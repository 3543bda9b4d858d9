// What    Which subtrees every part holds: those that most rays come to for their bytes, as far as bytes are
//         to spare. A ray that meets nothing else need not travel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace kdray::odprt {

// Stands in Division::part_of for a subtree that every part holds.
inline constexpr std::uint32_t kEveryPart = 0xffffffffu;

// A flag for each subtree. `visits`: how many rays come to it (a hit counts as some more), in any unit;
// `most_bytes`: of all that are chosen.
std::vector<bool> replicate(std::span<const double> visits, std::span<const std::uint64_t> bytes,
                            std::uint64_t most_bytes);

}  // namespace kdray::odprt
