// What    Rays into Embree's structs of N rays, and these through it.
#pragma once

#include <algorithm>
#include <limits>
#include <type_traits>

#include "bench/embree/query.h"

namespace kdray::bench::embree {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

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

// What a lane begins with.
template <unsigned N>
void put_ray(Rays<N>& rays, unsigned lane, const float* origin, const float* direction, float near = 0,
             float far = kInfinity) {
  for (int k = 0; k < 3; ++k) rays.origin[k][lane] = origin[k], rays.direction[k][lane] = direction[k];
  rays.t_near[lane] = near;
  rays.t_far[lane] = far;
  rays.time[lane] = 0;
  rays.mask[lane] = ~0u;
  rays.id[lane] = rays.flags[lane] = 0;
}
template <unsigned N>
void put_no_hit(RayHits<N>& packed, unsigned lane) {
  packed.hit.geometry[lane] = packed.hit.instance[lane] = kNone;
}
template <unsigned N>
void put_no_hit(Rays<N>&, unsigned) {}

// Traces rays [first, end), N at a time: put(rays, lane, i) puts ray i there, and take(packed, lane, i) finds
// what became of it.
template <unsigned N, bool any_hit, class Put, class Take>
void trace_rays(Scene scene, Query& query, std::size_t first, std::size_t end, const Put& put,
                const Take& take) {
  Packed<N, any_hit> packed;
  for (std::size_t at = first; at < end; at += N) {
    const auto n = static_cast<unsigned>(std::min<std::size_t>(N, end - at));
    alignas(64) int valid[N];
    for (unsigned lane = 0; lane < N; ++lane) {
      valid[lane] = lane < n ? -1 : 0;
      put(rays_of(packed), lane, at + std::min(lane, n - 1));
      put_no_hit(packed, lane);
    }
    query.trace(scene, valid, &packed);
    for (unsigned lane = 0; lane < n; ++lane) take(packed, lane, at + lane);
  }
}

}  // namespace kdray::bench::embree
