// What    The closest point of the scene to each of n points: its distance, place, primitive, u and v.
// Shape   One point to a work-item. reach: a radius in local lengths, beyond which nothing need be found (the
//         host compares the distance itself).
// Cost    reads 24 B of the point and the tree, writes 48 B.
// Errors  a leaf of an unknown kind gives the number KDRAY_CLOSEST_INVALID; the host checks for it.
#define KDRAY_WHOLE_TRIANGLES
#include "closest/walk.clh"
#include "layout/arguments.h"
#include "layout/traversal.h"

KDRAY_BODY void find_closest_point(u32 item, KDRAY_PARAMETERS(KDRAY_CLOSEST_POINTS_ARGUMENTS)) {
  const SceneArrays scene = KDRAY_SCENE_FROM_PARAMETERS(0);
  if (item >= n_points) return;
  PointWalk w;
  begin_point(&w, in_points + item, root_lo, root_hi, reach);
  walk_to_closest(&scene, &w);
  store_closest(&scene, &w, out_closest + item);
}

__kernel void closest_points(KDRAY_PARAMETERS(KDRAY_CLOSEST_POINTS_ARGUMENTS)) {
  find_closest_point((u32)get_global_id(0), KDRAY_HAND_ON(KDRAY_CLOSEST_POINTS_ARGUMENTS));
}
