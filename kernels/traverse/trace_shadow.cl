// What    Decides for each shadow ray of a wave whether its light is hidden, where every ray has a work-item.
// Shape   item i serves ray i % batch_size of light i / batch_size; its answer is the byte of its place in
//         the stream.
// Cost    reads 36 B of the ray and the tree, writes 1 B.
#define KDRAY_LANES 1u
#include "layout/arguments.h"
#include "traverse/trace_slice.clh"
#include "wave/shadow_place.clh"

KDRAY_BODY void trace_shadow_ray(u32 item, KDRAY_PARAMETERS(KDRAY_TRACE_SHADOW_ARGUMENTS)) {
  u32 place;
  if (!has_shadow_ray(frame, in_slices, in_shadow_rays, item, &place)) return;
  const SceneArrays scene = KDRAY_SCENE_FROM_PARAMETERS(0);
  const RaySource source = shadow_rays(frame, 0, in_shadow_rays, out_occluded);
  trace_one(&scene, frame, &source, place);
}

__kernel void trace_shadow(KDRAY_PARAMETERS(KDRAY_TRACE_SHADOW_ARGUMENTS)) {
  trace_shadow_ray((u32)get_global_id(0), KDRAY_HAND_ON(KDRAY_TRACE_SHADOW_ARGUMENTS));
}
