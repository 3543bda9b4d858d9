// What    Which pieces of a cut each ray passes on its way to its end, in order, and what it costs there.
// Shape   A walk of the whole wide tree from near to far, as a device does it; since it is known where a ray ends, no primitive
//         is tested. Between two pieces there may be a stay in the directory.
// Units   modes_cut.h's: a visit of a node 1, a test of a block 2.
#pragma once

#include <span>

#include "bench/modes_cut.h"
#include "bench/modes_lives.h"

namespace kdray::bench {

struct PieceVisit {
  std::uint32_t piece = 0;  // or kDirectory
  float cost = 0;
};

struct Paths {
  std::vector<PieceVisit> visits;
  std::vector<std::size_t> first = {0};  // of each ray, and the end of the last

  std::size_t n_rays() const { return first.size() - 1; }
  std::span<const PieceVisit> of(std::size_t ray) const {
    return std::span(visits).subspan(first[ray], first[ray + 1] - first[ray]);
  }
};

// `center`: of the scene, which the form's coordinates are about.
Paths find_paths(const flatten::WideForm& form, const Cut& cut, std::span<const LifeRay> lives,
                 const dvec3& center);

// What the owner of each piece has to do for all rays: the walks in it, those through the directory from it on, and `shade_cost`
// for each hit that is shaded. A ray that meets no piece belongs to the one where its parent ended.
std::vector<double> costs_of_pieces(const Paths& paths, std::span<const LifeRay> lives, std::size_t n_pieces,
                                    double shade_cost);

}  // namespace kdray::bench
