// What    t and the weights of triangles of doubles that lines cross for certain (exact_triangle.h), for
//         eight at once: in pairs of doubles, in the CPU's widest vectors (Highway).
// Errors  t as ExactLine::t_of, which is to be asked where cancellation leaves too little of a pair; weights
//         are off by 2^-51, but by more of triangles that are seen nearly edge-on or from over 2^50 times
//         their size away, and lie in [0, 1] as their sum does.
#pragma once

#include <cstddef>

#include "engine/query/exact_triangle.h"
#include "engine/query/local_rays.h"

namespace kdray::query {

// Lane by lane.
struct CrossedTriangles {
  static constexpr std::size_t kLanes = 8;
  double origin[3][kLanes], rest[3][kLanes], direction[3][kLanes], corner[3][3][kLanes];

  void put(std::size_t lane, const DoubleLine& line, const ExactLine::Corners& corners) {
    for (int k = 0; k < 3; ++k) {
      origin[k][lane] = line.origin[k];
      rest[k][lane] = line.rest[k];
      direction[k][lane] = line.direction[k];
      for (std::size_t c = 0; c < 3; ++c) corner[c][k][lane] = corners[c][k];
    }
  }
};

struct ToldHits {
  double t[CrossedTriangles::kLanes], u[CrossedTriangles::kLanes],
      v[CrossedTriangles::kLanes];           // u and v: of the second and third corner
  double is_sure[CrossedTriangles::kLanes];  // 0: t is not
};

void tell_hits(const CrossedTriangles& crossed, ToldHits& told);

}  // namespace kdray::query
