// What    Which pieces of a cut each ray passes on its way to its end, in order, and what it costs there.
// Shape   A walk of the whole wide tree from near to far, as a device does it; since it is known where a ray ends, no primitive
//         is tested. What the walk costs above the pieces counts for the piece that it leads to.
// Units   modes_cut.h's: a visit of a node 1, a test of a block 2.
#pragma once

#include <span>

#include "bench/modes_cut.h"
#include "bench/modes_lives.h"

namespace kdray::bench {

struct PieceVisit {
  std::uint32_t piece = 0;
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

// What each piece costs over all rays.
std::vector<double> costs_of_pieces(const Paths& paths, std::size_t n_pieces);

}  // namespace kdray::bench
