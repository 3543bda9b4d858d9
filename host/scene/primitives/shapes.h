// What    All shapes, complete. One line for each kind but triangles.
// Shape   What every shape S of the list must have, as plain functions (<kind>.h shows them in order):
//         - S with `material` and `number`, SGeometry with `source` (the place of its S in the scene) and
//           kFenceFactor, layout::S (kernels/layout) with `number` and `material`;
//         - fields_of: how JSON scenes name its fields;
//         - in a file (S): fault_of (null: none), bounds_of, middle_of, transform;
//         - in the tree (SGeometry): geometry_of, has_area (false: it is dropped), bounds_of, and
//           clip: bounds of the surface inside a region, which contain it whatever the rounding; empty ones
//           prove that the surface does not meet the closed region;
//         - for the kernels: pack (all but number and material), bounds_of (generous ones of layout::S) and
//           rows_of (its rows in a block but for the index);
//         - for queries: normal_at (of layout::S, at a point on it), crossings (of a line with it, in
//           double), distance_to (of a point, in double); for scenes of doubles, of S in the scene's own
//           space, normal_at, crossings (in pairs of doubles), nearest_on (of a point), and where floats may
//           tilt or flatten it apart and keep_height (as cones);
//         - for `kdray verify`: place_on (somewhere on it, or within its outline, for a share of 0 to 1 and
//           any unit direction), sure_target (the t of a hit that is certain by more than a margin),
//           meets_again (whether a hit at t is surely none of a ray that has just left it towards `side`).
#pragma once

#include "scene/primitives/capsule.h"
#include "scene/primitives/cone.h"
#include "scene/primitives/disc.h"
#include "scene/primitives/kinds.h"
#include "scene/primitives/sphere.h"
#include "scene/primitives/torus.h"
