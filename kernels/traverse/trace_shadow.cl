// What    Decides for each shadow ray of the slices whether its light is hidden. One ray per work-item.
// Shape   item i serves ray i % (batch_size*light_batch) of slice i / (batch_size*light_batch); its answer is
//         byte slice*shadow_capacity + ray of out_occluded.
// Cost    reads 36 B of the ray and the tree, writes 1 B.
#include "layout/arguments.h"
#include "traverse/trace_slice.clh"

__kernel void trace_shadow(KDRAY_PARAMETERS(KDRAY_TRACE_SHADOW_ARGUMENTS)) {
  const u32 item = (u32)get_global_id(0);
  const u32 per_slice = frame->batch_size * frame->light_batch;
  const u32 slice = item / per_slice, i = item % per_slice;
  if (slice >= n_slices || i >= in_slices[slice].n_shadow) return;
  const SceneArrays scene = KDRAY_SCENE_FROM_PARAMETERS(0);
  const RaySource source = shadow_rays(frame, slice, in_shadow_rays, out_occluded);
  trace_one(&scene, frame, &source, i);
}
