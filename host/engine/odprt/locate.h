// What    Tells which subtree of a cut a point lies in.
// Shape   Cells are disjoint, so that a point of a surface lies in one subtree's bounds, or, where rounding
//         has moved it out, nearest to them; on a plane between two, which hold what lies in it both, in
//         either.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/odprt/subtrees.h"

namespace kdray::odprt {

class Locator {
 public:
  // Refers to both.
  Locator(const flatten::WideForm& form, const Cut& cut) : form_(form), cut_(cut) {}

  // None for a cut without subtrees.
  std::optional<std::uint32_t> find(const vec3& point) const;

 private:
  struct Nearest {
    float distance;  // squared
    std::optional<std::uint32_t> subtree = {};
  };
  void look_below(std::size_t opened, const vec3& point, Nearest& nearest) const;

  const flatten::WideForm& form_;
  const Cut& cut_;
};

}  // namespace kdray::odprt
