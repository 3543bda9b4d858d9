// What    The extra channels of a picture (AOVs) from one eye ray per pixel, through its centre (or corner).
// Shape   One work-item per sixteen pixels; out_channels[pixel*7]: depth, normal x y z, primitive number,
//         cost, the instance's place in the scene's list. Nothing hit: depth inf, normal 0, primitive -1,
//         instance -1, as for the scene's own primitives. A failed walk: depth NaN, which the host takes for
//         an error. The binary tree is walked, except where there are instances, which only the wide form
//         has; that walk counts no cost.
#include "layout/arguments.h"
#include "layout/features.h"
#include "layout/rays.layout.h"
#include "raygen/primary.clh"
#include "shade/surface.clh"
#include "traverse/closest.clh"
#include "traverse/wide.clh"

// Sixteen numbers that are accessed one by one, by lane.
typedef struct Row {
  real lane[KDRAY_LANES];
} Row;

static inline Row row_of(realN v) {
  Row row;
  storeN(v, row.lane);
  return row;
}

// What an eye ray hits first.
typedef struct Seen {
  real t, u, v, cost;
  u32 ref, instance;  // 1 + the instance's index
} Seen;

static inline Seen see(const SceneArrays* scene, __constant const Frame* frame, const real* origin,
                       const real* direction, real t_min) {
#if KDRAY_HAS_INSTANCES
  RayIn in;
  for (int k = 0; k < 3; ++k) in.origin[k] = origin[k], in.direction[k] = direction[k];
  in.t_min = t_min;
  in.t_max = INFINITY;
  in.skip = KDRAY_REF_MISS;
  in.skip_instance = 0;
  in.any_hit = 0;
  WideRay r;
  begin_ray(&r, &in, frame->world_max);
  walk_wide(scene, &r);
  const Seen seen = {
      r.ref == KDRAY_REF_MISS ? INFINITY : r.t, r.wb / r.det, r.wc / r.det, 0.0f, r.ref, r.instance};
#else
  const TreeRay r =
      make_tree_ray((real3)(origin[0], origin[1], origin[2]),
                    (real3)(direction[0], direction[1], direction[2]), t_min, INFINITY, frame->world_max);
  u32 steps = 0;
  const Hit hit = find_closest(scene, &r, load3_constant(frame->root_lo), load3_constant(frame->root_hi),
                               KDRAY_REF_MISS, &steps);
  const Seen seen = {hit.t, hit.u, hit.v, (real)steps, hit.ref, 0};
#endif
  return seen;
}

KDRAY_BODY void write_channels(u32 first, KDRAY_PARAMETERS(KDRAY_CHANNELS_ARGUMENTS)) {
  if (first >= n_pixels) return;
  const u32 n = min(n_pixels - first, KDRAY_LANES);
  const SceneArrays scene = KDRAY_SCENE_FROM_PARAMETERS(0);
  const uintN pixel = first_pixel + first + KDRAY_LANE_NUMBERS;
  const Real2xN middle = {(realN)(0.5f), (realN)(0.5f)};
  const EyeRays rays = eye_rays(frame, pixel % frame->width, pixel / frame->width, middle);
  const Real3xN d = normalize3(rays.direction);
  const Row ox = row_of(rays.origin.x), oy = row_of(rays.origin.y), oz = row_of(rays.origin.z);
  const Row dx = row_of(d.x), dy = row_of(d.y), dz = row_of(d.z);
  const Row t_min = row_of(frame->hither / dot3(d, splat3(load3_constant(frame->forward))));
  // Lanes behind the last pixel take part in vectors as misses.
  Row t = row_of((realN)(INFINITY)), u = row_of((realN)(0.0f)), v = u, number = u, cost = u;
  word refs[KDRAY_LANES], instances[KDRAY_LANES];
  for (u32 i = 0; i < KDRAY_LANES; ++i) {
    refs[i] = KDRAY_REF_MISS;
    instances[i] = 0;
    if (i >= n) continue;
    const real origin[3] = {ox.lane[i], oy.lane[i], oz.lane[i]};
    const real direction[3] = {dx.lane[i], dy.lane[i], dz.lane[i]};
    const Seen hit = see(&scene, frame, origin, direction, t_min.lane[i]);
    const bool found = hit.ref < KDRAY_REF_INVALID;
    t.lane[i] = hit.ref == KDRAY_REF_INVALID ? NAN : hit.t;
    u.lane[i] = hit.u;
    v.lane[i] = hit.v;
    refs[i] = found ? hit.ref : KDRAY_REF_MISS;
    number.lane[i] = found ? (real)primitive_number(&scene, hit.ref) : -1.0f;
    instances[i] = found ? hit.instance : 0;
    cost.lane[i] = hit.cost;
  }
  const Hits hits = {
    loadN(t.lane),
    loadN(refs),
    loadN(u.lane),
    loadN(v.lane),
#if KDRAY_HAS_INSTANCES
    loadN(instances),
#endif
  };
  const SurfaceArrays arrays = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_SURFACE_ARRAYS);
  const lanesN hit = hits.ref != KDRAY_REF_MISS;
  Surface s;
  surfaces_at(&arrays, rays.origin, d, &hits, hit, &s);
  const Real3xN normal = select3(hit, s.shading, zero3());
  const Row nx = row_of(normal.x), ny = row_of(normal.y), nz = row_of(normal.z);
  for (u32 i = 0; i < n; ++i) {
    __global float* out = out_channels + (size_t)(first + i) * 7;
    out[0] = t.lane[i];
    store3(out + 1, (real3)(nx.lane[i], ny.lane[i], nz.lane[i]));
    out[4] = number.lane[i];
    out[5] = cost.lane[i];
#if KDRAY_HAS_INSTANCES  // those of empty meshes have a place in the list, and no index
    out[6] = instances[i] ? (float)scene.instances[instances[i] - 1].number : -1.0f;
#else
    out[6] = -1.0f;
#endif
  }
}

__kernel void channels(KDRAY_PARAMETERS(KDRAY_CHANNELS_ARGUMENTS)) {
  write_channels((u32)get_global_id(0) * KDRAY_LANES, KDRAY_HAND_ON(KDRAY_CHANNELS_ARGUMENTS));
}
