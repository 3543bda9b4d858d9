// What    Solids that POV-Ray's users begin with, made of kdray's kinds: boxes of twelve triangles, cylinders
//         and truncated cones that are closed by discs, planes that are discs so wide that they end far
//         beyond the scene.
// Shape   Parts as importers append them. What depends on the size of the scene is settled when all of it is
//         there (settle_solids).
// Errors  Where a wall and its lid meet, rounding could leave a gap. So lids lie inside of the wall's ends by
//         kSeal of the scene (in a point, where there is some width), and reach beyond the wall by more:
//         whichever way a ray enters, it crosses one of the two. That is less than what the tree's cells are
//         widened by (kernels/traverse/ray.clh), and far below a pixel.
#pragma once

#include <cstddef>
#include <vector>

#include "scene/model/scene.h"

namespace kdray::scene {

// Adds the triangles of a box, which face outwards; its corners are exact.
void add_box(Scene& part, const dvec3& corner, const dvec3& opposite);

// Gives the triangles of such a box, which is all that is there, the places that show a whole picture on each
// side: upright as seen from outside, with y up; on top as seen from z, below as it would fall on a mirror.
void add_box_texcoords(Scene& box);

struct Closed {
  dvec3 base{0}, apex{0};
  double base_radius = 0, apex_radius = 0;
};
struct Plane {
  dvec3 point{0}, normal{0, 1, 0};  // of unit length
  double extent = 0;                // how far it reaches around the point; 0: far beyond the scene
};

// Discs of a scene that get their final place and radius when the scene's size is known.
struct Unsettled {
  struct Lid {
    Closed of;
    bool at_apex = false;
    std::size_t disc = 0;  // into Scene::discs
  };
  struct Wide {
    Plane plane;
    std::size_t disc = 0;
  };
  std::vector<Lid> lids;
  std::vector<Wide> planes;
};

// Adds a cone and its lids, or a disc, to a part; `first_disc` is the number of discs that the scene has
// before it.
void add_closed(Scene& part, const Closed& closed, std::size_t first_disc, Unsettled& unsettled);
void add_plane(Scene& part, const Plane& plane, std::size_t first_disc, Unsettled& unsettled);

void settle_solids(const Unsettled& unsettled, Scene& scene);

// Returns what is wrong with a solid; nullptr where nothing is.
const char* fault_of(const Closed& closed);

}  // namespace kdray::scene
