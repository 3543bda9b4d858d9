// What    Finds the closest hit of each ray of the slices' batches. One ray per work-item.
// Shape   item i serves lane i % batch_size of slice i / batch_size; launch size >= n_slices * batch_size.
// Cost    reads 32 B of the ray and the tree, writes 16 B.
// Errors  a full stack marks the hit KDRAY_REF_INVALID; shade counts it.
#include "layout/features.h"
#include "layout/frame.layout.h"
#include "traverse/closest.clh"

__kernel void trace_closest(KDRAY_SCENE_PARAMETERS, __constant const Frame* frame, u32 n_slices,
                            __global const Slice* in_slices, __global const Ray* in_batch, __global Hit* out_hits) {
  const u32 item = (u32)get_global_id(0);
  const u32 slice = item / frame->batch_size;
  if (slice >= n_slices || item % frame->batch_size >= in_slices[slice].n_batch) return;
  const SceneArrays scene = KDRAY_SCENE_ARRAYS;
  __global const Ray* ray = in_batch + item;
  const TreeRay r =
      make_tree_ray(load3(ray->origin), load3(ray->direction), ray->t_min, INFINITY, frame->world_max);
  u32 cost;
  out_hits[item] =
      find_closest(&scene, &r, load3_constant(frame->root_lo), load3_constant(frame->root_hi), &cost);
}
