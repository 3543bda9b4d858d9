// What    Hits that lie in lists of equal size, one for each ray, moved together as structures of arrays.
// Shape   A work-item takes a ray; places[i] is where the hits of ray i begin.
// Cost    reads and writes 16 B for each hit.
#include "layout/arguments.h"
#include "layout/rays.layout.h"

__kernel void pack_hits(KDRAY_PARAMETERS(KDRAY_PACK_HITS_ARGUMENTS)) {
  const u32 i = (u32)get_global_id(0);
  if (i >= n_rays) return;
  __global const QueryHit* hits = in_hits + (size_t)i * capacity;
  const u32 n = in_spans[i].n_hits, first = in_places[i];
  for (u32 k = 0; k < n; ++k) {
    out_t[first + k] = hits[k].t;
    out_primitive[first + k] = (u32)hits[k].primitive;
    out_u[first + k] = hits[k].u;
    out_v[first + k] = hits[k].v;
  }
}
