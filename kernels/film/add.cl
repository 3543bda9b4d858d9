// What    Adds what the shadow rays of a wave bring to the film, where every ray has a work-item.
// Shape   item i serves ray i % batch_size of light i / batch_size. (A place without a ray is left alone.)
// Cost    reads 5 B, and of a ray that arrives 16 B more; adds to 24 B of film.
#define KDRAY_LANES 1u
#include "film/accumulate.clh"
#include "layout/arguments.h"
#include "wave/shadow_place.clh"
#include "wave/shared.clh"

__kernel void add(KDRAY_PARAMETERS(KDRAY_ADD_ARGUMENTS)) {
  u32 place;
  if (!has_shadow_ray(frame, io_slices, in_shadow_rays, (u32)get_global_id(0), &place)) return;
  const ConstStream rays = const_stream_of(in_shadow_rays, 0, KDRAY_SHADOW_FIELDS, frame->shadow_capacity);
  const uchar answer = in_occluded[place];
  if (answer == KDRAY_OCCLUSION_INVALID) add_shared(&io_slices->n_invalid, 1);
  if (answer != KDRAY_CLEAR) return;
  const u32 n_nan = accumulate(frame, io_film, true, as_wordN(readN(rays, KDRAY_SHADOW_PIXEL, place)),
                               read3xN(rays, KDRAY_SHADOW_CONTRIBUTION, place));
  add_shared(&io_slices->n_nan, n_nan);
}
