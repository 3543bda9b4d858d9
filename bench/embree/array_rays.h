// What    Rays out of arrays into Embree's structs of N rays, and through it.
#pragma once

#include <limits>
#include <type_traits>

#include "bench/embree/query.h"
#include "bench/workload/arrays.h"

namespace kdray::bench::embree {

// A form of tracing.
struct RayForm {
  bool coherent;
  unsigned lanes;  // 1, 16
};

template <unsigned N, bool any_hit>
using Packed = std::conditional_t<any_hit, Rays<N>, RayHits<N>>;

template <unsigned N>
Rays<N>& rays_of(Rays<N>& packed) {
  return packed;
}
template <unsigned N>
Rays<N>& rays_of(RayHits<N>& packed) {
  return packed.ray;
}

template <unsigned N>
inline void put_ray(Rays<N>& rays, unsigned lane, const QuerySet& set, std::size_t i) {
  for (std::size_t k = 0; k < 3; ++k) {
    rays.origin[k][lane] = set.origins[3 * i + k];
    rays.direction[k][lane] = set.directions[3 * i + k];
  }
  rays.t_near[lane] = rays.time[lane] = 0;
  rays.t_far[lane] = std::numeric_limits<float>::infinity();
  rays.mask[lane] = ~0u;
  rays.id[lane] = rays.flags[lane] = 0;
}

// Traces rays [first, end) of the set, N at a time: prepare(rays, lane, i) may add to ray i, and take(packed,
// lane, i) finds what became of it.
template <unsigned N, bool any_hit, class Prepare, class Take>
void trace_rays(Scene scene, Query& query, const QuerySet& set, std::size_t first, std::size_t end,
                const Prepare& prepare, const Take& take) {
  Packed<N, any_hit> packed;
  Rays<N>& rays = rays_of(packed);
  for (std::size_t at = first; at < end; at += N) {
    const auto n = static_cast<unsigned>(std::min<std::size_t>(N, end - at));
    alignas(64) int valid[N];
    for (unsigned lane = 0; lane < N; ++lane) {
      valid[lane] = lane < n ? -1 : 0;
      put_ray<N>(rays, lane, set, at + std::min(lane, n - 1));
      if constexpr (!any_hit) {
        packed.hit.geometry[lane] = packed.hit.instance[lane] = kNone;
      }
      prepare(rays, lane, at + lane);
    }
    query.trace(scene, valid, &packed);
    for (unsigned lane = 0; lane < n; ++lane) take(packed, lane, at + lane);
  }
}

}  // namespace kdray::bench::embree
