// What    Finds the closest hit of each ray of the slices' batches. One ray per work-item.
// Shape   item i serves ray i % batch_size of slice i / batch_size; launch size >= n_slices * batch_size.
// Cost    reads 36 B of the ray and the tree, writes 16 B.
// Errors  a full stack (binary tree) marks the hit KDRAY_REF_INVALID; shade counts it.
#include "layout/arguments.h"
#include "traverse/trace_slice.clh"

__kernel void trace_closest(KDRAY_PARAMETERS(KDRAY_TRACE_CLOSEST_ARGUMENTS)) {
  const u32 item = (u32)get_global_id(0);
  const u32 slice = item / frame->batch_size, i = item % frame->batch_size;
  if (slice >= n_slices || i >= in_slices[slice].n_batch) return;
  const SceneArrays scene = KDRAY_SCENE_FROM_PARAMETERS(0);
  const RaySource source = batch_rays(frame, slice, in_batch, out_hits);
  trace_one(&scene, frame, &source, i);
}
