// What    Faces that lie on each other: the same three corners twice, and different faces in one plane that
//         cover common ground.
// Shape   `doubled` holds a face of each such triple but for the first; `overlapping` pairs of others, each
//         once.
// Errors  Two faces are in one plane when no corner of either is farther from the other's plane than the
//         rounding of the coordinates allows (2^-22 of the largest of them): a plane that isn't along the
//         axes has no three floats exactly in it. They overlap when they reach into each other by more than
//         four times that, everywhere: what shares an edge or a corner doesn't, nor does what only overlaps
//         by rounding. Faces that run alongside each other farther apart are not found.
// Source  In the plane: separating axes, Gottschalk 1996.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "apps/verify/mesh.h"

namespace kdray::verify {

struct Duplicates {
  std::vector<std::uint32_t> doubled;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> overlapping;  // the smaller first, sorted
};

Duplicates find_duplicates(const Mesh& mesh, const Boxes& boxes);

// Returns whether the two faces lie in one plane and cover common ground; a face does so with itself.
bool overlap(const Mesh& mesh, std::uint32_t a, std::uint32_t b);

}  // namespace kdray::verify
