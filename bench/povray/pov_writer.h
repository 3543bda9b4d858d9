// What    A scene as a POV-Ray file, so that POV-Ray can be timed on the same picture.
// Shape   Spheres, open cones, discs, one mesh of all triangles (smooth ones with their normals); materials
//         as pigment and finish: ambient, diffuse, phong = (R.V)^shine, reflection, filter for what passes,
//         ior. POV-Ray itself works the way kdray's model does, but its shadows of transparent objects are
//         filtered, not black. A kind that lacks a word does not compile.
// Errors  What POV-Ray has no word for is left out: attenuation but by the distance's square, ranges, spots,
//         emission.
#pragma once

#include <iosfwd>

#include "scene/model/scene.h"

namespace kdray::bench {

// Whether nothing would be left out.
bool pov_has_words_for(const scene::Scene& scene);

// `depth` as kdray counts it: the eye ray is 1. Rays of less weight than `min_weight` are not followed.
void write_pov(std::ostream& out, const scene::Scene& scene, double aspect, int depth, double min_weight);

}  // namespace kdray::bench
