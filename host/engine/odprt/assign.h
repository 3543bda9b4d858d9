// What    Which parts hold which subtrees.
// Shape   Neighbours in the tree's order stay together, so that a ray meets few parts and few primitives lie
//         in several. Each part gets one run of subtrees: the largest part's cost is the least that can be
//         had where no part takes more than `most_bytes`, if that is possible at all; else the bound is
//         raised until it is. Where costs and bytes lie in different places that leaves parts far from equal;
//         then a part gets two runs, four, or more: as few as bring the largest to within a twentieth of the
//         mean. Every part holds those subtrees that most rays come to for their bytes, as far as bytes are
//         to spare: a ray that meets nothing else need not travel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace kdray::odprt {

// The part of each subtree; parts may stay empty. Costs are at least 0.
std::vector<std::uint32_t> assign_balanced(std::span<const double> costs,
                                           std::span<const std::uint64_t> bytes, std::uint32_t n_parts,
                                           std::uint64_t most_bytes);

// Stands in Division::part_of for a subtree that every part holds.
inline constexpr std::uint32_t kEveryPart = 0xffffffffu;

// Which subtrees every part holds: a flag for each. `visits`: how many rays come to it (a hit counts as some
// more), in any unit; `most_bytes`: of all that are chosen.
std::vector<bool> replicate(std::span<const double> visits, std::span<const std::uint64_t> bytes,
                            std::uint64_t most_bytes);

}  // namespace kdray::odprt
