// What    The extra channels of a picture (AOVs) from one eye ray per pixel, through its centre (or corner).
// Shape   One work-item per sixteen pixels; out_channels[pixel*6]: depth, normal x y z, primitive number,
//         cost. Nothing hit: depth inf, normal 0, primitive -1. A failed walk: depth NaN, which the host
//         takes for an error.
#include "layout/arguments.h"
#include "layout/features.h"
#include "layout/rays.layout.h"
#include "raygen/primary.clh"
#include "shade/surface.clh"
#include "traverse/closest.clh"

// Sixteen numbers in turn, by lane.
typedef struct Row {
  real lane[KDRAY_LANES];
} Row;

inline Row row_of(real16 v) {
  Row row;
  vstore16(v, 0, row.lane);
  return row;
}

__kernel void channels(KDRAY_PARAMETERS(KDRAY_CHANNELS_ARGUMENTS)) {
  const u32 first = (u32)get_global_id(0) * KDRAY_LANES;
  if (first >= n_pixels) return;
  const u32 n = min(n_pixels - first, KDRAY_LANES);
  const SceneArrays scene = KDRAY_SCENE_FROM_PARAMETERS(0);
  const uint16 pixel = first_pixel + first + (uint16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const Real2x16 middle = {(real16)(0.5f), (real16)(0.5f)};
  const EyeRays rays = eye_rays(frame, pixel % frame->width, pixel / frame->width, middle);
  const Real3x16 d = normalize3(rays.direction);
  const Row ox = row_of(rays.origin.x), oy = row_of(rays.origin.y), oz = row_of(rays.origin.z);
  const Row dx = row_of(d.x), dy = row_of(d.y), dz = row_of(d.z);
  const Row t_min = row_of(frame->hither / dot3(d, splat3(load3_constant(frame->forward))));
  // Lanes behind the last pixel are computed with: as a miss.
  Row t = row_of((real16)(INFINITY)), u = row_of((real16)(0.0f)), v = u, number = u, cost = u;
  word refs[KDRAY_LANES];
  for (u32 i = 0; i < KDRAY_LANES; ++i) {
    refs[i] = KDRAY_REF_MISS;
    if (i >= n) continue;
    const TreeRay r =
        make_tree_ray((real3)(ox.lane[i], oy.lane[i], oz.lane[i]),
                      (real3)(dx.lane[i], dy.lane[i], dz.lane[i]), t_min.lane[i], INFINITY, frame->world_max);
    u32 steps = 0;
    const Hit hit = find_closest(&scene, &r, load3_constant(frame->root_lo), load3_constant(frame->root_hi),
                                 KDRAY_REF_MISS, &steps);
    const bool found = hit.ref < KDRAY_REF_INVALID;
    t.lane[i] = hit.ref == KDRAY_REF_INVALID ? NAN : hit.t;
    u.lane[i] = hit.u;
    v.lane[i] = hit.v;
    refs[i] = found ? hit.ref : KDRAY_REF_MISS;
    number.lane[i] = found ? (real)primitive_number(&scene, hit.ref) : -1.0f;
    cost.lane[i] = (real)steps;
  }
  const Hits hits = {vload16(0, t.lane), vload16(0, refs), vload16(0, u.lane), vload16(0, v.lane)};
  const SurfaceArrays arrays = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_SURFACE_ARRAYS);
  const lanes16 hit = hits.ref != KDRAY_REF_MISS;
  Surface s;
  surfaces_at(&arrays, rays.origin, d, &hits, hit, &s);
  const Real3x16 normal = select3(hit, s.shading, zero3());
  const Row nx = row_of(normal.x), ny = row_of(normal.y), nz = row_of(normal.z);
  for (u32 i = 0; i < n; ++i) {
    __global float* out = out_channels + (size_t)(first + i) * 6;
    out[0] = t.lane[i];
    store3(out + 1, (real3)(nx.lane[i], ny.lane[i], nz.lane[i]));
    out[4] = number.lane[i];
    out[5] = cost.lane[i];
  }
}
