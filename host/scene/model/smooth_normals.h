// What    Normals for the triangles that have none, from the faces around each corner: the sum of their
//         normals, weighted by their angles there, over those that turn by no more than `degrees` against the
//         corner's own face. An edge that is sharper than that stays sharp. A triangle without area has no
//         face to be sharp against: it takes them all.
// Shape   Corners at the same place count as one, whichever vertices the file gives them.
// Cost    It takes as many steps as there are pairs of faces around a place. A place of over 1000 faces (the
//         tip of a fan) keeps its faces' own normals.
// Source  Thuermer and Wuethrich, "Computing vertex normals from polygonal facets", JGT 1998, for the
//         weights.
#pragma once

#include "scene/model/scene.h"

namespace kdray::scene {

void smooth_normals(Scene& scene, double degrees);

}  // namespace kdray::scene
