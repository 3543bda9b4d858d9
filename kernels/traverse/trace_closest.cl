// What    Finds the closest hits of a wave's rays, where every ray has a work-item.
// Cost    reads 36 B of the ray and the tree, writes 16 B.
// Errors  a full stack (binary tree) marks the hit KDRAY_REF_INVALID; shade counts it.
#define KDRAY_LANES 1u
#include "layout/arguments.h"
#include "traverse/trace_slice.clh"

KDRAY_BODY void trace_closest_hit(u32 i, KDRAY_PARAMETERS(KDRAY_TRACE_CLOSEST_ARGUMENTS)) {
  if (i >= in_slices->n_batch) return;
  const SceneArrays scene = KDRAY_SCENE_FROM_PARAMETERS(0);
  const RaySource source = batch_rays(frame, 0, in_batch, out_hits);
  trace_one(&scene, frame, &source, i);
}

__kernel void trace_closest(KDRAY_PARAMETERS(KDRAY_TRACE_CLOSEST_ARGUMENTS)) {
  trace_closest_hit((u32)get_global_id(0), KDRAY_HAND_ON(KDRAY_TRACE_CLOSEST_ARGUMENTS));
}
