// What    The origins of the rays that leave hits, by the code that shades, for kdray verify and the tests.
// Shape   in_rays[n], in_hits[n] (t, u, v and references) -> out_departures[n]; one work-item to sixteen
//         hits. All hits are hits.
// Cost    reads 48 B of ray and hit and the primitive, writes 40 B.
#include "layout/arguments.h"
#include "layout/rays.layout.h"
#include "layout/verify.layout.h"
#include "shade/surface.clh"

static inline Real3xN load_lanes3(const real* lanes) {
  const Real3xN r = {loadN(lanes), loadN(lanes + KDRAY_LANES), loadN(lanes + 2 * KDRAY_LANES)};
  return r;
}
static inline void store_lanes3(Real3xN v, real* lanes) {
  storeN(v.x, lanes), storeN(v.y, lanes + KDRAY_LANES), storeN(v.z, lanes + 2 * KDRAY_LANES);
}

__kernel void depart(KDRAY_PARAMETERS(KDRAY_DEPART_ARGUMENTS)) {
  const u32 first = (u32)get_global_id(0) * KDRAY_LANES;
  if (first >= n_rays) return;
  const u32 count = min(n_rays - first, KDRAY_LANES);
  real origin[3 * KDRAY_LANES], direction[3 * KDRAY_LANES], t[KDRAY_LANES], u[KDRAY_LANES], v[KDRAY_LANES];
  word ref[KDRAY_LANES];
  for (u32 lane = 0; lane < KDRAY_LANES; ++lane) {
    const u32 i = first + min(lane, count - 1);
    for (u32 k = 0; k < 3; ++k) {
      origin[k * KDRAY_LANES + lane] = in_rays[i].origin[k];
      direction[k * KDRAY_LANES + lane] = in_rays[i].direction[k];
    }
    t[lane] = in_hits[i].t, ref[lane] = in_hits[i].ref, u[lane] = in_hits[i].u, v[lane] = in_hits[i].v;
  }
  const SurfaceArrays arrays = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_SURFACE_ARRAYS);
  const Hits hits = {
    loadN(t),
    loadN(ref),
    loadN(u),
    loadN(v),
#if KDRAY_HAS_INSTANCES
    (wordN)(0u),
#endif
  };
  Surface s;
  surfaces_at(&arrays, load_lanes3(origin), load_lanes3(direction), &hits, lanes_up_to(count), &s);
  real front[3 * KDRAY_LANES], back[3 * KDRAY_LANES], normal[3 * KDRAY_LANES];
  store_lanes3(offset_origin(s.point, s.point_error, s.normal), front);
  store_lanes3(offset_origin(s.point, s.point_error, negate3(s.normal)), back);
  store_lanes3(s.normal, normal);
  for (u32 lane = 0; lane < count; ++lane) {
    Departure d;
    for (u32 k = 0; k < 3; ++k) {
      d.front[k] = (float)front[k * KDRAY_LANES + lane];
      d.back[k] = (float)back[k * KDRAY_LANES + lane];
      d.normal[k] = (float)normal[k * KDRAY_LANES + lane];
    }
    d.pad = 0;
    out_departures[first + lane] = d;
  }
}
