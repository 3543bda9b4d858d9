// What    Rays out of arrays into Embree's structs of N rays, and through it.
#pragma once

#include <limits>
#include <type_traits>

#include "bench/embree/api.h"
#include "bench/workload/arrays.h"

namespace kdray::bench {

// A form of tracing.
struct RayForm {
  bool coherent;
  unsigned lanes;  // 1, 16
};

template <unsigned N, bool any_hit>
using Packed = std::conditional_t<any_hit, typename Packet<N>::AnyRay, typename Packet<N>::ClosestRay>;

template <unsigned N>
inline void put_ray(RTCRayN* rays, unsigned lane, const QuerySet& set, std::size_t i) {
  RTCRayN_org_x(rays, N, lane) = set.origins[3 * i];
  RTCRayN_org_y(rays, N, lane) = set.origins[3 * i + 1];
  RTCRayN_org_z(rays, N, lane) = set.origins[3 * i + 2];
  RTCRayN_dir_x(rays, N, lane) = set.directions[3 * i];
  RTCRayN_dir_y(rays, N, lane) = set.directions[3 * i + 1];
  RTCRayN_dir_z(rays, N, lane) = set.directions[3 * i + 2];
  RTCRayN_tnear(rays, N, lane) = 0;
  RTCRayN_tfar(rays, N, lane) = std::numeric_limits<float>::infinity();
  RTCRayN_time(rays, N, lane) = 0;
  RTCRayN_mask(rays, N, lane) = ~0u;
  RTCRayN_id(rays, N, lane) = 0;
  RTCRayN_flags(rays, N, lane) = 0;
}

// Traces rays [first, end) of the set, N at a time: prepare(rays, lane, i) may add to ray i, and take(packed,
// lane, i) finds what became of it.
template <unsigned N, bool any_hit, class Prepare, class Take>
void trace_rays(RTCScene scene, Query& query, const QuerySet& set, std::size_t first, std::size_t end,
                const Prepare& prepare, const Take& take) {
  Packed<N, any_hit> packed;
  auto* const rays = reinterpret_cast<RTCRayN*>(&packed);
  for (std::size_t at = first; at < end; at += N) {
    const auto n = static_cast<unsigned>(std::min<std::size_t>(N, end - at));
    alignas(64) int valid[N];
    for (unsigned lane = 0; lane < N; ++lane) {
      valid[lane] = lane < n ? -1 : 0;
      put_ray<N>(rays, lane, set, at + std::min(lane, n - 1));
      if constexpr (!any_hit) {
        RTCHitN* const hit = RTCRayHitN_HitN(reinterpret_cast<RTCRayHitN*>(&packed), N);
        RTCHitN_geomID(hit, N, lane) = RTC_INVALID_GEOMETRY_ID;
        RTCHitN_instID(hit, N, lane, 0) = RTC_INVALID_GEOMETRY_ID;
      }
      prepare(rays, lane, at + lane);
    }
    query.trace(scene, valid, &packed);
    for (unsigned lane = 0; lane < n; ++lane) take(packed, lane, at + lane);
  }
}

}  // namespace kdray::bench
