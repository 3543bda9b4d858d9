// What    Whose subtrees each ray passes on its way to its end, in order, and what it costs there.
// Shape   A walk of the whole wide tree from near to far, as a device does it; since it is known where a ray
//         ends, no primitive is tested. Subtrees have owners, their roots and the opened nodes above belong
//         to the directory, as host/engine/odprt/division.h makes it: between two owners there may be a stay
//         in it.
// Units   A visit of a node counts 1, a test of a block 2 (TreeOptions' own weights).
#pragma once

#include <span>
#include <vector>

#include "bench/modes/lives.h"
#include "engine/odprt/subtrees.h"

namespace kdray::bench {

// The directory, as an owner.
inline constexpr std::uint32_t kDirectory = ~0u;

struct Visit {
  std::uint32_t owner = 0;  // or kDirectory
  float cost = 0;
};

struct Paths {
  std::vector<Visit> visits;
  std::vector<std::size_t> first = {0};  // of each ray, and the end of the last

  std::size_t n_rays() const { return first.size() - 1; }
  std::span<const Visit> of(std::size_t ray) const {
    return std::span(visits).subspan(first[ray], first[ray + 1] - first[ray]);
  }
};

// `owner_of` has the owner of each of the cut's subtrees; `space` is the scene's, which the form's
// coordinates are about.
Paths find_paths(const flatten::WideForm& form, const odprt::Cut& cut,
                 std::span<const std::uint32_t> owner_of, std::span<const LifeRay> lives,
                 const LocalSpace& space);

// What each owner has to do for all rays: the walks in what is its own, those through the directory from
// there on, and `shade_cost` for each hit that is shaded. A ray that meets nothing belongs to the one where
// its parent ended.
std::vector<double> costs_of_owners(const Paths& paths, std::span<const LifeRay> lives, std::size_t n_owners,
                                    double shade_cost);

}  // namespace kdray::bench
