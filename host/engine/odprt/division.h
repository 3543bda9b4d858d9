// What    A scene divided for ODPRT: its subtrees, the part of each, and the parts' geometry.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/odprt/parts.h"
#include "engine/odprt/subtrees.h"

namespace kdray::odprt {

struct Division {
  std::vector<std::uint32_t> part_of;  // of each subtree; kEveryPart (replicate.h)
  std::vector<layout::PartCell> directory;
  std::vector<Part> parts;

  bool replicates() const;  // some subtrees are in every part
  // The subtrees of a part, in the order of the census.
  std::vector<std::uint32_t> subtrees_of(std::uint32_t part) const;
};

// The bytes of the geometry of the largest part.
std::size_t largest_bytes(const Division& division);

struct DivideOptions {
  std::uint32_t n_parts = 1;
  double spare = 0;       // of the scene's bytes, that a part may take beyond an equal share, if possible
  double replicated = 0;  // ... of which so much may be what every part holds

  bool operator==(const DivideOptions&) const = default;
};

// The share of the geometry that a part may take beyond its equal one, where memory is not short; and what of
// that may be held by every part.
inline constexpr double kSpare = 0.19, kReplicated = 0.16;

// The part of each subtree, or kEveryPart. `costs` of the subtrees, of any unit.
std::vector<std::uint32_t> assign(const Cut& cut, std::span<const double> costs,
                                  const DivideOptions& options);

Division divide(const flatten::FlatScene& scene, const flatten::WideForm& form, const Cut& cut,
                std::span<const double> costs, const DivideOptions& options);
// By what somebody has assigned.
Division divide(const flatten::FlatScene& scene, const flatten::WideForm& form, const Cut& cut,
                std::vector<std::uint32_t> part_of, std::uint32_t n_parts);

}  // namespace kdray::odprt
