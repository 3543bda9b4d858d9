// What    A scene divided for ODPRT: its subtrees, the part of each, and the parts' geometry.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "odprt/parts.h"
#include "odprt/subtrees.h"

namespace kdray::odprt {

struct Division {
  std::vector<std::uint32_t> part_of;  // of each subtree
  std::vector<layout::PartCell> directory;
  std::vector<Part> parts;

  // The subtrees of a part, in the order of the census.
  std::vector<std::uint32_t> subtrees_of(std::uint32_t part) const;
};

// `costs` of the subtrees, of any unit. A part takes no more than an equal share of the bytes and `spare` of the whole, if possible.
Division divide(const flatten::FlatScene& scene, const flatten::WideForm& form, const Cut& cut,
                std::span<const double> costs, std::uint32_t n_parts, double spare);

}  // namespace kdray::odprt
