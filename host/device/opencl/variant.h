// What    A program whose place others can take: programs of the same source that differ in the feature mask
//         (KDRAY_FEATURES), or in sizes, and give the same answers bit for bit.
// Shape   `options` is all but the mask; `instead` holds options that serve as well, from the best on. A mask
//         covers the wanted one when it has all its bits, and no others but spare ones.
// Why     Compilers take seconds, and what a scene doesn't need costs a program that has it a few percent
//         (docs/design/start.md).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace kdray::device {

struct Variant {
  std::string options;
  std::vector<std::string> instead = {};
  std::uint64_t mask = 0;   // what is wanted
  std::uint64_t spare = 0;  // what a program may have beside it
};

// The whole options of a program with this mask.
std::string options_with(const std::string& options, std::uint64_t mask);

bool covers(std::uint64_t mask, const Variant& wanted);

// Those of `masks` that cover what is wanted, the one with the fewest other bits first.
std::vector<std::uint64_t> covering(std::vector<std::uint64_t> masks, const Variant& wanted);

}  // namespace kdray::device
