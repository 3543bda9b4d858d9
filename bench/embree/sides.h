// What    Embree as sides of `bench queries`: a fast scene and a robust one, each in the forms of all Embrees
//         that are there. Without Embree there are none. A first answer is the newest one's.
#pragma once

#include "bench/race/asker.h"

namespace kdray::bench {

// The mesh has to outlive them.
std::vector<Side> embree_sides(const MeshArrays& mesh, int threads);

// Whether Embree has a way to answer it.
bool embree_answers(Question question);

}  // namespace kdray::bench
