// What    Shades the hits of a wave's rays (shade.clh), where every ray has a work-item.
#define KDRAY_LANES 1u
#include "layout/arguments.h"
#include "shade/shade.clh"

KDRAY_BODY void shade_ray(Shading* c, const SurfaceArrays* arrays, const TexturingArrays* texturing,
                          __global const Light* in_lights, u32 first_light, ConstStream batch,
                          ConstStream hits, __global i64* io_film) {
  const u32 i = c->ray;
  for (u32 k = 0; k < c->frame->light_batch; ++k)
    write1(c->shadow, KDRAY_RAY_T_MAX, shadow_place(c->frame, k, i), -INFINITY);
  const bool is_ray = (u32)as_word(read1(batch, KDRAY_RAY_PIXEL, i)) != KDRAY_NO_PIXEL;
  shade_rays(c, arrays, texturing, in_lights, first_light, batch, hits, i, is_ray, io_film);
}

__kernel void shade(KDRAY_PARAMETERS(KDRAY_SHADE_ARGUMENTS)) {
  __local Tally of_group;
#if KDRAY_HAS_REFLECT || KDRAY_HAS_TRANSMIT  // PoCL 6 ends with a failed assertion where nothing uses it
  __local u32 spawned[2];
#endif
  const u32 i = (u32)get_global_id(0);
  const SurfaceArrays arrays = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_SURFACE_ARRAYS);
  const TexturingArrays texturing = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_TEXTURING_ARRAYS);
  const SkyArrays sky = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_SKY_ARRAYS);
  Shading c = begin_shading(frame, &sky, 0, io_slices, first_light, io_pool, out_shadow_rays);
  if (i < io_slices->n_batch) {
    c.ray = i;
    shade_ray(&c, &arrays, &texturing, in_lights, first_light,
              const_stream_of(in_batch, 0, KDRAY_RAY_FIELDS, frame->batch_capacity),
              const_stream_of(in_hits, 0, KDRAY_HIT_FIELDS, frame->batch_capacity), io_film);
  }
#if KDRAY_HAS_REFLECT || KDRAY_HAS_TRANSMIT
  put_all_into_pool(&c, spawned);
#endif
  add_tally(io_slices, &c.tally, &of_group);
}
