// What    Decides for each shadow ray of the slices whether its light is hidden. One ray per work-item.
// Shape   item i serves place i % (batch_size*light_batch) of slice i / (batch_size*light_batch).
// Cost    reads 32 B of the ray and the tree, writes 1 B.
#include "layout/features.h"
#include "layout/frame.layout.h"
#include "traverse/any.clh"

__kernel void trace_shadow(KDRAY_SCENE_PARAMETERS, __constant const Frame* frame, u32 n_slices,
                           __global const Slice* in_slices, __global const ShadowRay* in_shadow_rays,
                           __global uchar* out_occluded) {
  const u32 item = (u32)get_global_id(0);
  const u32 per_slice = frame->batch_size * frame->light_batch;
  const u32 slice = item / per_slice;
  if (slice >= n_slices || item % per_slice >= in_slices[slice].n_shadow) return;
  const SceneArrays scene = KDRAY_SCENE_ARRAYS;
  __global const ShadowRay* ray = in_shadow_rays + item;
  const TreeRay r =
      make_tree_ray(load3(ray->origin), load3(ray->direction), 0.0f, ray->t_max, frame->world_max);
  out_occluded[item] = (uchar)find_any(&scene, &r, load3_constant(frame->root_lo),
                                       load3_constant(frame->root_hi), ray->skip);
}
